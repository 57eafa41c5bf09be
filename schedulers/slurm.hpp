// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "schedulers/scheduler.hpp"

namespace grouser {

/// Slurm through its commands: sbatch, squeue, sacct, scancel. Text output with explicit formats
/// is used, because it is the interface that stayed the same over Slurm's versions.
class SlurmScheduler : public Scheduler {
 public:
  SubmitAnswer submit(const JobRequest& request) override;
  QueryAnswer query(const std::vector<JobKey>& jobs) override;
  std::string cancel(const JobKey& job, CancelMode mode) override;
};

/// The job id in what `sbatch --parsable` printed ("1234" or "1234;cluster"). Local.
std::optional<std::string> parse_sbatch(const std::string& out);

/// What a failed sbatch means, from its words. Local.
SubmitAnswer::Kind judge_sbatch_failure(const std::string& message);

/// Lines "id|name|state|reason" of squeue; nothing when a line is not of that form. Local.
std::optional<std::vector<JobStatus>> parse_squeue(const std::string& out);

/// Lines "id|name|state|exit:signal" of sacct; nothing when a line is not of that form. Local.
std::optional<std::vector<JobStatus>> parse_sacct(const std::string& out);

}  // namespace grouser
