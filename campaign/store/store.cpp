// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/store.hpp"

#include <map>

#include "campaign/store/change.hpp"
#include "campaign/store/database.hpp"
#include "campaign/store/tables.hpp"

namespace grouser {
namespace {

void add_axes(SQLite::Database& database, std::vector<RunRow>& runs) {
  std::map<std::int64_t, RunRow*> by_id;
  for (RunRow& run : runs) by_id[run.id.value] = &run;
  // Of one run, the table is not read as a whole.
  SQLite::Statement statement(database, std::string("SELECT run_id, axis, label FROM run_axis ") +
                                            (runs.size() == 1 ? "WHERE run_id = ? " : "") +
                                            "ORDER BY run_id, position");
  if (runs.size() == 1) statement.bind(1, runs.front().id.value);
  while (statement.executeStep()) {
    const auto found = by_id.find(statement.getColumn(0).getInt64());
    if (found == by_id.end()) continue;
    found->second->axes.push_back(
        {statement.getColumn(1).getString(), statement.getColumn(2).getString()});
  }
}

void insert_after(SQLite::Database& database, const ChunkRow& chunk) {
  // Positions are unique at every moment, so the later chunks move up by way of negative ones.
  SQLite::Statement away(database,
                         "UPDATE chunk SET position = -position - 1 "
                         "WHERE run_id = ? AND position >= ?");
  away.bind(1, chunk.run.value);
  away.bind(2, chunk.position);
  away.exec();
  SQLite::Statement back(database,
                         "UPDATE chunk SET position = -position WHERE run_id = ? AND position < 0");
  back.bind(1, chunk.run.value);
  back.exec();
  insert_row(database, chunk);
}

void drop_planned_chunks(SQLite::Database& database, RunId run) {
  SQLite::Statement statement(
      database,
      "DELETE FROM chunk WHERE run_id = ? AND state IN ('PLANNED', 'READY') "
      "AND NOT EXISTS (SELECT 1 FROM attempt a WHERE a.chunk_id = chunk.id)");
  statement.bind(1, run.value);
  statement.exec();
}

template <class Row>
std::vector<Row> rows_of(SQLite::Database& database, std::optional<RunId> run,
                         const std::string& order) {
  return guarded(database, [&] {
    return run ? select_rows<Row>(database, "WHERE run_id = ? ORDER BY " + order, run->value)
               : select_rows<Row>(database, "ORDER BY run_id, " + order);
  });
}

}  // namespace

Store::Store(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

Store Store::open_read_only(const std::filesystem::path& file) {
  auto impl = std::make_unique<Impl>();
  impl->database = open_database(file, false);
  return Store(std::move(impl));
}

Store Store::open(const std::filesystem::path& file) {
  auto impl = std::make_unique<Impl>();
  const auto journal = file.parent_path() / kJournalName;
  std::error_code unreadable;
  if (!std::filesystem::exists(file, unreadable) && Journal(journal).last_number() > 0)
    throw FormatError(file.string() + ": is gone, but its journal is there; `grouser rebuild -C " +
                      file.parent_path().string() + "` makes it anew");
  impl->database = open_database(file, true);
  impl->journal = std::make_unique<Journal>(file.parent_path() / kJournalName);
  impl->inode = inode_of(file);
  return Store(std::move(impl));
}

Store Store::open_for_replay(const std::filesystem::path& file) {
  auto impl = std::make_unique<Impl>();
  impl->database = open_database(file, true);
  // A crash in between is no loss: it is begun anew.
  impl->database->execAndGet("PRAGMA journal_mode = MEMORY");
  impl->database->exec("PRAGMA synchronous = OFF");
  impl->is_replay = true;
  return Store(std::move(impl));
}

std::int64_t Store::change_number() const {
  SQLite::Database& database = *impl_->database;
  return guarded(database,
                 [&] { return database.execAndGet("SELECT number FROM journal").getInt64(); });
}

bool Store::has_campaign() const {
  SQLite::Database& database = *impl_->database;
  return guarded(database,
                 [&] { return database.execAndGet("SELECT count(*) FROM campaign").getInt() > 0; });
}

CampaignRow Store::campaign() const {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&] {
    SQLite::Statement statement(
        database, "SELECT name, title, source, settings, engine, created_at FROM campaign");
    if (!statement.executeStep()) throw FormatError(database.getFilename() + ": holds no campaign");
    CampaignRow row;
    ColumnReader reader(statement, 0);
    columns_of_campaign(reader, row);
    return row;
  });
}

std::vector<RunRow> Store::runs() const {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&] {
    auto runs = select_rows<RunRow>(database, "ORDER BY id");
    add_axes(database, runs);
    return runs;
  });
}

RunRow Store::run(RunId id) const {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&] {
    auto runs = select_rows<RunRow>(database, "WHERE id = ?", id.value);
    GROUSER_CHECK(runs.size() == 1);
    add_axes(database, runs);
    return runs.front();
  });
}

std::vector<ChunkRow> Store::chunks(std::optional<RunId> run) const {
  return rows_of<ChunkRow>(*impl_->database, run, "position");
}

std::vector<AttemptRow> Store::attempts(std::optional<RunId> run) const {
  return rows_of<AttemptRow>(*impl_->database, run, "number");
}

std::vector<AttemptRow> Store::ended_last(int count) const {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&] {
    return select_rows<AttemptRow>(
        database, "WHERE ended_at > 0.0 ORDER BY ended_at DESC, id DESC LIMIT ?", count);
  });
}

double Store::occupied_seconds() const {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&] {
    return database.execAndGet("SELECT total(occupied_seconds) FROM v_ledger").getDouble();
  });
}

std::vector<AttemptRow> Store::active_attempts() const {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&] {
    return select_rows<AttemptRow>(
        database, "WHERE state IN ('SUBMITTING', 'QUEUED', 'RUNNING', 'UNKNOWN') ORDER BY run_id");
  });
}

AttemptRow Store::add_attempt(const AttemptRow& attempt, const RunRow& run, const ChunkRow& chunk) {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&] {
    WriteTransaction transaction(database);
    impl_->confirm_lease();
    AttemptRow row = attempt;
    SQLite::Statement last(database,
                           "SELECT coalesce(max(number), 0) FROM attempt WHERE run_id = ?");
    last.bind(1, run.id.value);
    last.executeStep();
    row.number = last.getColumn(0).getInt64() + 1;
    last.reset();
    row.id.value = insert_row(database, row);
    update_row(database, run);
    update_row(database, chunk);
    impl_->note(json_of(attempt, run, chunk));
    transaction.commit();
    return row;
  });
}

void Store::apply(const Change& change) {
  SQLite::Database& database = *impl_->database;
  guarded(database, [&] {
    WriteTransaction transaction(database);
    impl_->confirm_lease();
    if (change.attempt) update_row(database, *change.attempt);
    if (change.chunk) update_row(database, *change.chunk);
    if (change.run) update_row(database, *change.run);
    if (change.chunk_after) insert_after(database, *change.chunk_after);
    if (change.drop_planned_chunks) {
      GROUSER_CHECK(change.run.has_value());
      drop_planned_chunks(database, change.run->id);
    }
    impl_->note(json_of(change));
    transaction.commit();
  });
}

}  // namespace grouser
