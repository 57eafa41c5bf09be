// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/run_contract.hpp"
#include "campaign/store/rows.hpp"
#include "schedulers/scheduler.hpp"
#include "schedulers/scripts.hpp"

namespace grouser {

/// All that can be known about an attempt at one moment: the files of its run directory and the
/// scheduler's word.
struct Evidence {
  std::optional<Outcome> outcome;
  std::optional<JobRecord> started;  ///< the job script's word that it began
  std::optional<JobRecord> exit;     ///< and that it ended
  std::optional<JobStatus> job;      ///< as the scheduler knows it
  bool scheduler_answered = false;   ///< so that `job` missing means that it does not know it
  std::string why_not_answered;
  std::optional<CheckpointManifest> newest;  ///< complete checkpoint with the largest step
  std::int64_t progress_step = 0;            ///< of progress.json if it is this attempt's
};

/// Reads the files; a record that cannot be read counts as not there. Local.
Evidence read_evidence(const std::filesystem::path& run_directory, const std::string& token);

/// The complete checkpoint with the largest step. Local.
std::optional<CheckpointManifest> newest_checkpoint(const std::filesystem::path& run_directory);

/// progress.json, if it is there and readable. Local.
std::optional<Progress> read_progress(const std::filesystem::path& run_directory);

}  // namespace grouser
