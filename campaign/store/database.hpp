// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <memory>
#include <string>

#include "base/errors.hpp"
#include "campaign/store/journal_mode.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

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

  /// Inside a write transaction: the lease must still be ours; its beat goes up.
  void confirm_lease();
};

std::optional<LeaseHolder> read_lease(SQLite::Database& database);

}  // namespace grouser
