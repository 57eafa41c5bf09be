// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "campaign/store/store.hpp"

namespace grouser {

/// Makes a database from the journal of a campaign root, in `database`, which must not exist.
/// @param until  the last change to be taken; 0 = all
/// @return number of the last change taken
/// @throws FormatError where the journal is damaged; StorageError. Local.
std::int64_t replay_journal(const std::filesystem::path& root,
                            const std::filesystem::path& database, std::int64_t until = 0);

/// Puts a database made from the journal in the place of `grouser.db`; what was there is kept
/// beside it under another name.
/// @return the name of what was there, "" when nothing was. @throws as replay_journal. Local.
std::string rebuild_database(const std::filesystem::path& root);

/// Where the rows of two databases differ, one sentence each, runs named by their directory. Local.
std::vector<std::string> row_differences(const Store& database, const Store& journal);

}  // namespace grouser
