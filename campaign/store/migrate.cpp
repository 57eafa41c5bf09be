// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "campaign/store/database.hpp"
#include "schema_sql.hpp"

namespace grouser {
namespace {

// Each step turns version `to - 1` into `to`. A new version adds a step and never edits an old one.
struct Migration {
  int to;
  const char* sql;
};

// Attempts know how many threads their ranks had; those of version 1 had one.
constexpr const char* kThreadsSql = R"sql(
ALTER TABLE attempt ADD COLUMN threads INTEGER NOT NULL DEFAULT 1;

DROP VIEW v_attempts;
CREATE VIEW v_attempts AS
  SELECT a.id AS attempt_id, r.label AS run, c.position AS chunk, a.number, a.token, a.job, a.state,
         a.code, a.has_outcome, a.outcome_class, a.reason, a.created_at,
         nullif(a.submitted_at, 0.0) AS submitted_at, nullif(a.running_at, 0.0) AS running_at,
         nullif(a.ended_at, 0.0) AS ended_at, a.start_step, a.step, a.time AS time_s, a.steps_done,
         a.ranks, a.threads, a.wall_seconds, a.compute_seconds, a.checkpoint_seconds, a.checkpoint,
         a.state_hash, a.engine_hash
  FROM attempt a JOIN run r ON r.id = a.run_id JOIN chunk c ON c.id = a.chunk_id
  ORDER BY a.run_id, a.number;

DROP VIEW v_ledger;
CREATE VIEW v_ledger AS
  SELECT r.id AS run_id, r.label AS run, count(a.id) AS attempts,
         total(CASE WHEN a.submitted_at > 0 AND a.running_at > 0
                    THEN max(a.running_at - a.submitted_at, 0.0) END) AS queued_seconds,
         total(a.wall_seconds) AS wall_seconds,
         total(a.compute_seconds) AS compute_seconds,
         total(a.checkpoint_seconds) AS checkpoint_seconds,
         total(a.wall_seconds - a.compute_seconds - a.checkpoint_seconds) AS other_seconds,
         total(CASE WHEN a.has_outcome = 0 AND a.running_at > 0 AND a.ended_at > 0
                    THEN a.ended_at - a.running_at END) AS lost_seconds,
         total(a.wall_seconds * a.ranks) AS rank_seconds,
         total(a.wall_seconds * a.ranks * a.threads) AS core_seconds,
         coalesce(sum(a.steps_done), 0) AS steps_done
  FROM run r LEFT JOIN attempt a ON a.run_id = r.id
  GROUP BY r.id ORDER BY r.id;
)sql";

constexpr std::array kMigrations{Migration{1, kSchemaSql}, Migration{2, kThreadsSql}};

}  // namespace

int present_version() { return kMigrations.back().to; }

void migrate(SQLite::Database& database) {
  const auto version = [&] { return database.execAndGet("PRAGMA user_version").getInt(); };
  if (version() == present_version()) return;
  WriteTransaction transaction(database);
  // Asked again under the lock: another process may have migrated meanwhile.
  const int found = version();
  if (found > present_version())
    throw FormatError(database.getFilename() + ": version " + std::to_string(found) +
                      ", written by a newer grouser; this one knows up to " +
                      std::to_string(present_version()));
  if (found == 0 && database.execAndGet("SELECT count(*) FROM sqlite_master").getInt() > 0)
    throw FormatError(database.getFilename() + ": not a database of grouser");
  for (const Migration& step : kMigrations)
    if (step.to > found) database.exec(step.sql);
  database.exec("PRAGMA user_version = " + std::to_string(present_version()));
  transaction.commit();
}

}  // namespace grouser
