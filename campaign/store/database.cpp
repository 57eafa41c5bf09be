// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/database.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>

#include "campaign/store/storage_advice.hpp"

namespace grouser {
namespace {

constexpr int kBusyMilliseconds = 30000;

// f_type of file systems that several hosts mount, from statfs(2) and their own headers.
constexpr std::array<unsigned long, 11> kSharedFileSystems{
    0x6969,      // NFS
    0x0BD00BD0,  // Lustre
    0x47504653,  // GPFS
    0x19830326,  // BeeGFS
    0x65735546,  // FUSE
    0xFF534D42,  // CIFS
    0xFE534D42,  // SMB 2
    0x00C36400,  // Ceph
    0x01021997,  // 9P
    0xAAD7AAEA,  // PanFS
    0x5346414F,  // AFS
};

unsigned long file_system_of(const std::filesystem::path& file) {
  struct statfs answer {};
  const auto directory = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (::statfs(directory.c_str(), &answer) != 0) return kSharedFileSystems.front();
  return static_cast<unsigned long>(static_cast<unsigned int>(answer.f_type));
}

// Of two that change the mode at once SQLite refuses one straight away, whatever its time limit.
// Asks first: a change, even to what it is, needs a lock that a reader may hold.
void set_journal(SQLite::Database& database, const std::string& wanted) {
  constexpr std::chrono::milliseconds kPause{20};
  const auto limit =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(kBusyMilliseconds);
  for (;;) {
    try {
      if (database.execAndGet("PRAGMA journal_mode").getString() == wanted) return;
      database.execAndGet("PRAGMA journal_mode = " + wanted);
      return;
    } catch (const SQLite::Exception& error) {
      if (error.getErrorCode() != SQLITE_BUSY || std::chrono::steady_clock::now() > limit) throw;
    }
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace

JournalMode journal_mode_for(unsigned long file_system) {
  const bool is_shared = std::find(kSharedFileSystems.begin(), kSharedFileSystems.end(),
                                   file_system) != kSharedFileSystems.end();
  return is_shared ? JournalMode{"DELETE", "FULL"} : JournalMode{"WAL", "FULL"};
}

void create_private(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor >= 0) ::close(descriptor);  // else SQLite says why
}

std::uintmax_t inode_of(const std::filesystem::path& file) {
  struct stat answer {};
  return ::stat(file.c_str(), &answer) == 0 ? static_cast<std::uintmax_t>(answer.st_ino) : 0;
}

std::unique_ptr<SQLite::Database> open_database(const std::filesystem::path& file, bool to_write) {
  try {
    std::error_code unreadable;
    if (!to_write && !std::filesystem::exists(file, unreadable))
      throw StorageError(file.string() + ": " +
                         (unreadable ? unreadable.message()
                                     : "there is no such database; if its journal is there, "
                                       "`grouser rebuild` makes it anew"));
    if (to_write) create_private(file);
    const int flags =
        to_write ? SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE : SQLite::OPEN_READONLY;
    auto database = std::make_unique<SQLite::Database>(file.string(), flags, kBusyMilliseconds);
    if (to_write) {
      const JournalMode mode = journal_mode_for(file_system_of(file));
      database->exec("PRAGMA foreign_keys = ON");
      set_journal(*database, std::string(mode.journal) == "WAL" ? "wal" : "delete");
      database->exec(std::string("PRAGMA synchronous = ") + mode.synchronous);
      migrate(*database);
    } else if (database->execAndGet("PRAGMA user_version").getInt() != present_version()) {
      throw FormatError(file.string() + ": a database of another version of grouser, or none; " +
                        "run `grouser tick` to bring an older one up to date");
    }
    return database;
  } catch (const SQLite::Exception& error) {
    throw storage_error(file.string(), error.getErrorCode(), error.what());
  }
}

StorageError storage_error(const std::string& file, int code, const std::string& message) {
  const std::string advice = storage_advice(code);
  return StorageError(file + ": " + message + (advice.empty() ? "" : "; " + advice));
}

WriteTransaction::WriteTransaction(SQLite::Database& database) : database_(database) {
  database_.exec("BEGIN IMMEDIATE");
}

WriteTransaction::~WriteTransaction() {
  if (is_open_) database_.tryExec("ROLLBACK");
}

void WriteTransaction::commit() {
  database_.exec("COMMIT");
  is_open_ = false;
}

}  // namespace grouser
