// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "campaign/store/columns.hpp"

namespace grouser {

/// Ties a row struct to its table; specialised below.
template <class Row>
struct TableOf;
template <>
struct TableOf<RunRow> {
  static constexpr const char* name = "run";
  template <class Visitor, class Row>
  static void visit(Visitor& v, Row& r) {
    columns_of_run(v, r);
  }
};
template <>
struct TableOf<ChunkRow> {
  static constexpr const char* name = "chunk";
  template <class Visitor, class Row>
  static void visit(Visitor& v, Row& r) {
    columns_of_chunk(v, r);
  }
};
template <>
struct TableOf<AttemptRow> {
  static constexpr const char* name = "attempt";
  template <class Visitor, class Row>
  static void visit(Visitor& v, Row& r) {
    columns_of_attempt(v, r);
  }
};

template <class Row>
std::string column_list() {
  ColumnNames list;
  const Row row;
  TableOf<Row>::visit(list, row);
  std::string text;
  for (const std::string& name : list.names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Rows of the table, `clause` being WHERE and ORDER BY.
template <class Row>
std::vector<Row> select_rows(SQLite::Database& database, const std::string& clause,
                             std::optional<std::int64_t> parameter = std::nullopt) {
  SQLite::Statement statement(
      database, "SELECT id, " + column_list<Row>() + " FROM " + TableOf<Row>::name + " " + clause);
  if (parameter) statement.bind(1, *parameter);
  std::vector<Row> rows;
  while (statement.executeStep()) {
    Row& row = rows.emplace_back();
    row.id.value = statement.getColumn(0).getInt64();
    ColumnReader reader(statement, 1);
    TableOf<Row>::visit(reader, row);
  }
  return rows;
}

/// @return the id given to the row
template <class Row>
std::int64_t insert_row(SQLite::Database& database, const Row& row) {
  ColumnNames list;
  TableOf<Row>::visit(list, row);
  std::string marks;
  for (std::size_t i = 0; i < list.names.size(); ++i) marks += i == 0 ? "?" : ", ?";
  SQLite::Statement statement(database, std::string("INSERT INTO ") + TableOf<Row>::name + " (" +
                                            column_list<Row>() + ") VALUES (" + marks + ")");
  ColumnBinder binder(statement);
  TableOf<Row>::visit(binder, row);
  statement.exec();
  return database.getLastInsertRowid();
}

template <class Row>
void update_row(SQLite::Database& database, const Row& row) {
  ColumnNames list;
  TableOf<Row>::visit(list, row);
  std::string assignments;
  for (const std::string& name : list.names)
    assignments += (assignments.empty() ? "" : ", ") + name + " = ?";
  SQLite::Statement statement(database, std::string("UPDATE ") + TableOf<Row>::name + " SET " +
                                            assignments + " WHERE id = ?");
  ColumnBinder binder(statement);
  TableOf<Row>::visit(binder, row);
  statement.bind(binder.next(), row.id.value);
  GROUSER_CHECK(statement.exec() == 1);
}

}  // namespace grouser
