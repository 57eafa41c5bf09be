// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace grouser {

/// A job about to be handed over. The script is complete in itself.
struct JobRequest {
  std::string name;                      ///< job_name of the token
  std::filesystem::path script;          ///< absolute
  std::filesystem::path work_directory;  ///< absolute; the run directory
  std::filesystem::path log;             ///< absolute; where its output goes
};

/// By what a job is looked for. `id` may be unknown, the name carries the token and never is.
struct JobKey {
  std::string name;
  std::string id;
  double submitted_at = 0.0;  ///< on the manager's clock [s since 1970]
};

/// What came of asking the scheduler to take a job.
struct SubmitAnswer {
  enum class Kind {
    kAccepted,  ///< `job` is its id
    kRefused,   ///< it does not have the job and will not take it as it is
    kBusy,      ///< it does not have the job now; the same request may pass later
    kUnclear,   ///< it may or may not have the job: look for the name before anything else
  };
  Kind kind = Kind::kUnclear;
  std::string job;
  std::string message;  ///< the scheduler's own words
};

/// How a job ended, as far as the scheduler knows.
enum class JobEnd {
  kNone,  ///< not ended
  kDone,  ///< exit code 0
  kFailed,
  kKilled,  ///< by a signal, or it vanished without a word
  kCancelled,
  kDrained,  ///< cancelled by another user than the one who submitted it
  kTimeout,
  kPreempted,
  kNodeFailed,
  kOutOfMemory,
};

enum class JobPhase { kQueued, kRunning, kEnded };

struct JobStatus {
  std::string name;
  std::string id;
  JobPhase phase = JobPhase::kQueued;
  JobEnd end = JobEnd::kNone;
  int exit_code = -1;  ///< -1 = unknown
  std::string detail;  ///< the scheduler's own word: state or reason for waiting
};

/// Jobs the scheduler knows among those asked for. A job that is not in the list is absent only if
/// the answer is complete; otherwise nothing is known about it.
struct QueryAnswer {
  bool is_complete = false;
  std::string why_not;  ///< why it is not complete
  std::vector<JobStatus> jobs;
};

enum class CancelMode {
  kTerminate,  ///< TERM, so that the job may end in order
  kKill,       ///< at once
};

/// Who runs jobs. Implementations ask and report; they decide nothing and keep no state of their
/// own, so that a new manager process knows as much as the old one.
class Scheduler {
 public:
  virtual ~Scheduler() = default;
  virtual SubmitAnswer submit(const JobRequest& request) = 0;
  virtual QueryAnswer query(const std::vector<JobKey>& jobs) = 0;
  /// @return "" when the request was passed on, else why not
  virtual std::string cancel(const JobKey& job, CancelMode mode) = 0;
};

/// Job name of a token: at most 15 characters, starting with a letter, as old batch systems want.
/// The members of an array share theirs and are told apart by `_INDEX` behind it, here only.
std::string job_name(const std::string& token);

/// Characters of a token that is not an array's; a member's has `n` and its index behind it.
inline constexpr std::size_t kTokenLength = 12;
std::string member_token(const std::string& array_token, std::size_t index);

}  // namespace grouser
