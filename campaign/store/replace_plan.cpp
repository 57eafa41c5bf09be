// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/change.hpp"
#include "campaign/store/database.hpp"
#include "campaign/store/tables.hpp"

namespace grouser {

void put_campaign(SQLite::Database& database, const CampaignRow& campaign) {
  SQLite::Statement statement(
      database,
      "INSERT OR REPLACE INTO campaign (name, title, source, settings, engine, created_at, id) "
      "VALUES (?, ?, ?, ?, ?, ?, 1)");
  ColumnBinder binder(statement);
  columns_of_campaign(binder, campaign);
  statement.exec();
}

void put_axes(SQLite::Database& database, std::int64_t run, const std::vector<AxisLabel>& axes) {
  SQLite::Statement old(database, "DELETE FROM run_axis WHERE run_id = ?");
  old.bind(1, run);
  old.exec();
  SQLite::Statement statement(
      database, "INSERT INTO run_axis (run_id, position, axis, label) VALUES (?, ?, ?, ?)");
  for (std::size_t i = 0; i < axes.size(); ++i) {
    statement.bind(1, run);
    statement.bind(2, static_cast<std::int64_t>(i));
    statement.bind(3, axes[i].axis);
    statement.bind(4, axes[i].label);
    statement.exec();
    statement.reset();
  }
}

namespace {

// A run of the sweep that has no wheel may have the same grains; only the shared bed stays in the
// plan as long as a wheel run needs it.
RunId bed_of_key(SQLite::Database& database, const std::string& key) {
  SQLite::Statement statement(database,
                              "SELECT id FROM run WHERE kind = 'bed' AND key = ? "
                              "ORDER BY directory LIKE 'beds/%' DESC, id");
  statement.bind(1, key);
  GROUSER_CHECK(statement.executeStep());
  return {statement.getColumn(0).getInt64()};
}

void insert_run(SQLite::Database& database, const NewRun& added) {
  RunRow row = added.row;
  if (!added.bed_key.empty()) row.bed = bed_of_key(database, added.bed_key);
  const std::int64_t id = insert_row(database, row);
  put_axes(database, id, row.axes);
  ChunkRow chunk;
  chunk.run.value = id;
  for (const auto& end : added.chunk_ends) {
    chunk.until_time = end;
    insert_row(database, chunk);
    ++chunk.position;
  }
}

void update_runs(SQLite::Database& database, const std::vector<RunRow>& runs) {
  // Labels are unique at every moment, so all give theirs away before any takes a new one. No label
  // of a run has a slash.
  SQLite::Statement away(database, "UPDATE run SET label = '/' || id WHERE id = ?");
  for (const RunRow& run : runs) {
    away.bind(1, run.id.value);
    away.exec();
    away.reset();
  }
  for (const RunRow& run : runs) {
    update_row(database, run);
    put_axes(database, run.id.value, run.axes);
  }
}

std::vector<ChunkRow> keep_begun_chunks(SQLite::Database& database, RunId run) {
  SQLite::Statement drop(database,
                         "DELETE FROM chunk WHERE run_id = ? "
                         "AND NOT EXISTS (SELECT 1 FROM attempt a WHERE a.chunk_id = chunk.id)");
  drop.bind(1, run.value);
  drop.exec();
  SQLite::Statement clear(database,
                          "UPDATE chunk SET state = 'PLANNED', step = 0, time = 0.0 "
                          "WHERE run_id = ?");
  clear.bind(1, run.value);
  clear.exec();
  return select_rows<ChunkRow>(database, "WHERE run_id = ? ORDER BY position", run.value);
}

// Whether the chunks lead at least as far as `end`.
bool reaches(const std::vector<ChunkRow>& chunks, const std::optional<double>& end) {
  if (chunks.empty()) return false;
  const auto& until = chunks.back().until_time;
  return !until || (end && *end <= *until);
}

void cut_anew(SQLite::Database& database, const Recut& recut) {
  const auto kept = keep_begun_chunks(database, recut.run);
  ChunkRow chunk;
  chunk.run = recut.run;
  chunk.position = kept.empty() ? 0 : kept.back().position + 1;
  for (const auto& end : recut.ends) {
    if (reaches(kept, end)) continue;
    chunk.until_time = end;
    insert_row(database, chunk);
    ++chunk.position;
  }
}

}  // namespace

void Store::replace_plan(const PlanChange& change) {
  SQLite::Database& database = *impl_->database;
  guarded(database, [&] {
    WriteTransaction transaction(database);
    impl_->confirm_lease();
    put_campaign(database, change.campaign);
    update_runs(database, change.runs);
    for (const NewRun& run : change.added) insert_run(database, run);
    for (const Recut& recut : change.recut) cut_anew(database, recut);
    impl_->note(json_of(change));
    transaction.commit();
  });
}

}  // namespace grouser
