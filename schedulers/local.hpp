// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "schedulers/process.hpp"
#include "schedulers/scheduler.hpp"

namespace grouser {

/// Jobs as processes of this machine. A job is a session of its own, detached from the manager,
/// and tells about itself in files, so that any later manager finds the truth:
///
///     JOBS/NAME/wrapper.sh  starts the job's script
///     JOBS/NAME/started     host, boot id, pid and start time of the session's leader
///     JOBS/NAME/exit        exit code
///     JOBS/NAME/cancelled   a request to cancel came before the job had started
///
/// The id of a job is its name. A job runs as long as any process of its session does.
class LocalScheduler : public Scheduler {
 public:
  /// @param jobs_directory absolute; made when needed
  explicit LocalScheduler(std::filesystem::path jobs_directory);

  SubmitAnswer submit(const JobRequest& request) override;
  QueryAnswer query(const std::vector<JobKey>& jobs) override;
  std::string cancel(const JobKey& job, CancelMode mode) override;

 private:
  std::optional<ProcessId> leader(const std::string& name) const;

  std::filesystem::path jobs_;
};

/// The script that leads the session of a local job; a pure function. Local.
std::string make_local_wrapper(const std::filesystem::path& job_directory,
                               const JobRequest& request);

/// Processors this process may use. Local.
int available_cores();

}  // namespace grouser
