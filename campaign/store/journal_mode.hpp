// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// How a database file is kept on a kind of file system.
struct JournalMode {
  const char* journal;      ///< PRAGMA journal_mode
  const char* synchronous;  ///< PRAGMA synchronous
};

/// WAL needs shared memory between processes, which network file systems do not give.
/// @param file_system  f_type of statfs
JournalMode journal_mode_for(unsigned long file_system);

}  // namespace grouser
