// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "campaign/drive/compare.hpp"

namespace grouser {

/// Brings the plan into the campaign root. Surface files and run directories with their frozen
/// cases come first, then the database in one transaction, then the directories that are made again
/// and the cancelling of runs that the YAML no longer has, last the frozen YAML. Doing it again,
/// after a crash at any point too, ends the same. Needs the lease.
/// @param root    absolute
/// @param source  absolute path of the YAML
/// @throws StorageError; FormatError when a run directory holds another case
void launch_plan(const Plan& plan, const std::filesystem::path& source,
                 const std::filesystem::path& engine, const std::filesystem::path& root, double now,
                 Store& store);

}  // namespace grouser
