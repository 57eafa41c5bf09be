// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/plan/expand.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// The root of an existing campaign, absolute. `where` is the root, a campaign's name below
/// ./runs, or a campaign's YAML; "" is this directory if it is a root, else the only campaign
/// below ./runs. @throws ConfigError naming what there is; StorageError. Local.
std::filesystem::path find_root(const std::string& where);

/// The roots of several; of none named, all campaigns below ./runs. @throws as find_root. Local.
std::vector<std::filesystem::path> find_roots(const std::vector<std::string>& where);

/// The root for a campaign of that name: `given`, or runs/NAME here. Absolute. Local.
std::filesystem::path root_of(const std::string& name, const std::string& given);

/// Reads, expands and checks a campaign file, the recordings its report names and, for scheduler
/// `local`, this machine included. Warnings go to standard error.
/// @throws ConfigError with every problem. Local.
Plan checked_plan(const std::string& file, const std::string& site);

/// Runs whose label or directory name matches one of the shell patterns; all when `all`.
/// @throws ConfigError when a pattern matches nothing. Local.
std::vector<RunRow> select_runs(const Store& store, const std::vector<std::string>& patterns,
                                bool all);

/// The engine's program: `given`, else GROUSER_ENGINE, else beside this program, else on PATH.
/// Absolute. @throws ConfigError when there is none that can be executed. Local.
std::filesystem::path find_engine(const std::string& given);

}  // namespace grouser
