// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/plan/expand.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// Name of the frozen copy of the campaign's YAML in its root.
inline constexpr const char* kFrozenCampaign = "campaign.yaml";

/// What bringing a plan into a campaign root comes to.
struct LaunchReport {
  bool is_new = false;             ///< there was no campaign yet
  std::vector<std::string> added;  ///< labels of new runs
  std::vector<std::string> gone;   ///< labels of runs that the YAML no longer has; they are kept
  bool settings_changed = false;   ///< scheduler, resources or retries
  bool yaml_changed = false;       ///< any byte of the file
};

/// Compares a plan with the campaign in `store` without changing anything.
LaunchReport compare_plan(const Plan& plan, const std::filesystem::path& source,
                          const std::filesystem::path& root, const Store& store);

/// Writes the run directories with their frozen cases, then the campaign and its new runs into the
/// database, then the frozen YAML. Runs that are there already are left alone, so that doing it
/// again, after a crash at any point too, ends the same. Needs the lease.
/// @param root    absolute
/// @param source  absolute path of the YAML
/// @throws StorageError; FormatError when a run directory holds another case
void launch_plan(const Plan& plan, const std::filesystem::path& source,
                 const std::filesystem::path& engine, const std::filesystem::path& root, double now,
                 Store& store);

}  // namespace grouser
