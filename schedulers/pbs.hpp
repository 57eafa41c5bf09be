// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "schedulers/scheduler.hpp"

namespace grouser {

/// PBS through its commands: qsub, qstat, qselect, qdel. The text of `qstat -f` is used; its JSON
/// turns names that look like numbers into numbers.
class PbsScheduler : public Scheduler {
 public:
  SubmitAnswer submit(const JobRequest& request) override;
  QueryAnswer query(const std::vector<JobKey>& jobs) override;
  std::string cancel(const JobKey& job, CancelMode mode) override;
};

/// The job id in what qsub printed ("1234.server"). Local.
std::optional<std::string> parse_qsub(const std::string& out);

/// Jobs in the text of `qstat -f`; nothing when it is not of that form. Local.
std::optional<std::vector<JobStatus>> parse_qstat(const std::string& out);

/// Whether every line of qstat's complaints only says that a job is not known or has finished, so
/// that the rest of the answer counts. Local.
bool is_only_unknown_jobs(const std::string& err);

}  // namespace grouser
