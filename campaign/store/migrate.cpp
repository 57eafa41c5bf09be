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

constexpr std::array kMigrations{Migration{1, kSchemaSql}, Migration{2, kSchema2Sql}};

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
