// SPDX-License-Identifier: BSD-3-Clause
#include <sqlite3.h>

#include <memory>

#include "campaign/store/database.hpp"
#include "campaign/store/storage_advice.hpp"

namespace grouser {
namespace {

struct StatementDeleter {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Prepared = std::unique_ptr<sqlite3_stmt, StatementDeleter>;

// Reading is all that is let through: no ATTACH, PRAGMA or transaction either.
int allow_reading(void*, int action, const char*, const char*, const char*, const char*) {
  switch (action) {
    case SQLITE_SELECT:
    case SQLITE_READ:
    case SQLITE_FUNCTION:
    case SQLITE_RECURSIVE:
      return SQLITE_OK;
    default:
      return SQLITE_DENY;
  }
}

class ReadingOnly {
 public:
  explicit ReadingOnly(sqlite3* handle) : handle_(handle) {
    sqlite3_set_authorizer(handle_, allow_reading, nullptr);
  }
  ReadingOnly(const ReadingOnly&) = delete;
  ReadingOnly& operator=(const ReadingOnly&) = delete;
  ~ReadingOnly() { sqlite3_set_authorizer(handle_, nullptr, nullptr); }

 private:
  sqlite3* handle_;
};

// A damaged or unreachable file is no mistake of the statement.
[[noreturn]] void refuse(const SQLite::Database& database, int code) {
  const char* const message = sqlite3_errmsg(database.getHandle());
  if (!storage_advice(code).empty()) throw storage_error(database.getFilename(), code, message);
  throw std::invalid_argument(message);
}

Prepared prepare(const SQLite::Database& database, const std::string& sql) {
  sqlite3* const handle = database.getHandle();
  sqlite3_stmt* statement = nullptr;
  const char* rest = nullptr;
  const int code = sqlite3_prepare_v2(handle, sql.c_str(), -1, &statement, &rest);
  Prepared prepared(statement);
  if (code == SQLITE_AUTH)
    throw std::invalid_argument("only reading is allowed: one SELECT over the views");
  if (code != SQLITE_OK) refuse(database, code);
  if (!prepared) throw std::invalid_argument("there is no statement in it");
  if (std::string(rest).find_first_not_of(" \t\r\n;") != std::string::npos)
    throw std::invalid_argument("only one statement at a time");
  return prepared;
}

std::string text_at(sqlite3_stmt* statement, int column) {
  const auto* text = sqlite3_column_text(statement, column);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

}  // namespace

Table Store::query(const std::string& sql) const {
  const SQLite::Database& database = *impl_->database;
  const ReadingOnly guard(database.getHandle());
  const Prepared statement = prepare(database, sql);
  const int count = sqlite3_column_count(statement.get());
  Table table;
  for (int i = 0; i < count; ++i)
    table.columns.emplace_back(sqlite3_column_name(statement.get(), i));
  for (;;) {
    const int code = sqlite3_step(statement.get());
    if (code == SQLITE_DONE) return table;
    if (code != SQLITE_ROW) refuse(database, code);
    auto& row = table.rows.emplace_back();
    auto& is_text = table.is_text.emplace_back();
    for (int i = 0; i < count; ++i) {
      const int type = sqlite3_column_type(statement.get(), i);
      is_text.push_back(type == SQLITE_TEXT || type == SQLITE_BLOB);
      row.push_back(text_at(statement.get(), i));
    }
  }
}

}  // namespace grouser
