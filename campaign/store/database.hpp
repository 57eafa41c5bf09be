// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "base/errors.hpp"
#include "campaign/store/journal.hpp"
#include "campaign/store/journal_mode.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// Only its owner may read or write it. Local.
void create_private(const std::filesystem::path& file);

/// Opens the file and sets busy timeout, journal and foreign keys; checks or migrates the schema.
std::unique_ptr<SQLite::Database> open_database(const std::filesystem::path& file, bool to_write);

/// Brings an empty or older database to the present version. @throws FormatError for a newer one.
void migrate(SQLite::Database& database);
int present_version();

/// Everything between construction and commit() happens at once or not at all. Takes the write lock
/// at the start, so that it never fails half-way for a lock.
class WriteTransaction {
 public:
  explicit WriteTransaction(SQLite::Database& database);
  WriteTransaction(const WriteTransaction&) = delete;
  WriteTransaction& operator=(const WriteTransaction&) = delete;
  ~WriteTransaction();
  void commit();

 private:
  SQLite::Database& database_;
  bool is_open_ = true;
};

/// SQLite's complaint as ours: file, what happened, what to do.
StorageError storage_error(const std::string& file, int code, const std::string& message);

/// Runs `work` and turns SQLite's exceptions into ours, naming the file.
template <class Work>
auto guarded(const SQLite::Database& database, const Work& work) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    throw storage_error(database.getFilename(), error.getErrorCode(), error.what());
  }
}

struct Store::Impl {
  std::unique_ptr<SQLite::Database> database;
  std::optional<LeaseHolder> lease;  ///< ours, once taken
  std::unique_ptr<Journal> journal;  ///< none in a database that is made from one
  bool is_replay = false;            ///< changes come from the journal: no lease, no new line
  std::uintmax_t inode = 0;          ///< of the file as it was opened

  /// Inside a write transaction: the lease must still be ours and the file in its place; the
  /// lease's beat goes up.
  void confirm_lease();
  /// Last thing inside a write transaction: the change goes to the journal under a new number.
  void note(nlohmann::json change);
  /// With the lease: a journal that lacks changes of the database gets them, all at once.
  void complete_journal(const Store& store);
};

void put_campaign(SQLite::Database& database, const CampaignRow& campaign);
void put_axes(SQLite::Database& database, std::int64_t run, const std::vector<AxisLabel>& axes);
std::uintmax_t inode_of(const std::filesystem::path& file);

std::optional<LeaseHolder> read_lease(SQLite::Database& database);

}  // namespace grouser
