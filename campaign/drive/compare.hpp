// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/plan/expand.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// What bringing a plan into a campaign root comes to; runs are named by their labels.
struct LaunchReport {
  bool is_new = false;               ///< there was no campaign yet
  std::vector<std::string> added;    ///< new runs
  std::vector<std::string> gone;     ///< the YAML no longer has them: cancelled, their files kept
  std::vector<std::string> back;     ///< the YAML has them again
  std::vector<std::string> anew;     ///< their directory is gone: they start anew
  std::vector<std::string> lost;     ///< their directory is gone, but a job of theirs is active
  std::vector<std::string> recased;  ///< their frozen case changes where its key does not
  std::vector<std::string> recased_active;  ///< those of them whose job reads it only the next time
  std::vector<std::string> kept_chunks;     ///< cut otherwise by the YAML, but they have begun
  std::vector<std::string> changed_keys;    ///< top-level keys of the YAML that differ
  bool settings_changed = false;            ///< scheduler, resources or retries, site included

  /// Whether something that was submitted is to be otherwise, which a person must want.
  bool is_change() const;
};

/// A plan against the campaign that is there, and all that brings the two together.
struct Comparison {
  LaunchReport report;
  PlanChange change;                          ///< `campaign` left out
  std::vector<const PlannedRun*> to_prepare;  ///< new, or with another frozen case
  std::vector<const PlannedRun*> to_remake;   ///< whose directory is gone
};

/// Compares without changing anything; the result points into `plan`.
Comparison compare_runs(const Plan& plan, const std::filesystem::path& root, const Store& store);

/// The same and the YAML files: the frozen copy in `root` against `source`, comments and layout
/// left out. @throws ConfigError when `source` is no YAML
LaunchReport compare_plan(const Plan& plan, const std::filesystem::path& source,
                          const std::filesystem::path& root, const Store& store);

/// Text of a run's frozen case. Pure.
std::string frozen_case(const PlannedRun& run);

/// Whether a run's directory, or its frozen case, which is never taken away, is not there. Local.
bool is_directory_gone(const std::filesystem::path& run_directory);

}  // namespace grouser
