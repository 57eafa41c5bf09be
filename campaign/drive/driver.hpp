// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/drive/clock.hpp"
#include "campaign/drive/decide.hpp"
#include "campaign/drive/submit.hpp"

namespace grouser {

/// What one tick did; `messages` are sentences for people, in order.
struct TickReport {
  int submitted = 0;
  int ended = 0;
  std::vector<std::string> messages;
};

/// How patient a tick is; what is not given is the scheduler kind's own.
struct Patience {
  std::optional<double> grace;  ///< how long a job may be absent [s]
};

/// Carries a campaign on: looks at every active attempt, settles those that ended, submits what may
/// be submitted. It keeps nothing between ticks that is not in the database or in files, so a tick
/// by another process goes on where this one stopped. Needs the lease during tick().
class Driver {
 public:
  Driver(const std::filesystem::path& root, Store& store, Scheduler& scheduler, Clock& clock,
         const Patience& patience = {});

  TickReport tick();

 private:
  void look_at_active();
  void look_at(const AttemptRow& attempt, const QueryAnswer& answer);
  void carry_out_request(const RunRow& run, const AttemptRow& attempt);
  void end_attempt(const Change& change);
  void advance_runs();
  void write_wake_script() const;
  bool is_pausing();
  // Nothing when the run is held instead.
  std::optional<Submission> prepare(const RunRow& planned, const RunRow* bed, std::size_t active);
  void submit(const Submission& submission);
  void submit_together(const std::vector<Submission>& submissions, std::int64_t at_once);
  JobSettings settings_for(const Submission& submission) const;
  void hold(const RunRow& run, const ChunkRow& chunk, const std::string& reason);
  RunRow without_suspect(const RunRow& run, const std::vector<AttemptRow>& attempts);
  std::int64_t job_limit() const;

  std::filesystem::path root_;
  Store& store_;
  Scheduler& scheduler_;
  Clock& clock_;
  JobSettings shared_;
  const SchedulerKind& kind_;
  Policy policy_;
  TickReport report_;
  std::vector<AttemptRow> ended_;  // the last ones, last first
};

/// Whether nothing more will happen without a person: every run has ended, is held, or waits for
/// one that is; of a run that the YAML no longer has, no job is left. Pure.
bool is_at_rest(const std::vector<RunRow>& runs);

/// Whether a further tick soon has something to do although no job ends until then: an end that is
/// to be confirmed, a job that cannot be found, a retry that waits for its time. Pure.
bool needs_another_look(const std::vector<RunRow>& runs, const std::vector<AttemptRow>& active,
                        double now);

/// How patient the manager is with jobs of that kind. Pure.
Policy policy_of(const SchedulerKind& kind, const Settings& settings, const Patience& patience);

/// By what the jobs of the attempts are looked for. Pure.
std::vector<JobKey> keys_of(const std::vector<AttemptRow>& attempts);

/// Files of the run directory and the scheduler's answer, as far as they are about the attempt.
Evidence evidence_of(const std::filesystem::path& root, const RunRow& run,
                     const AttemptRow& attempt, const QueryAnswer& answer);

/// The chunk that the attempt tries.
ChunkRow chunk_of(const Store& store, const AttemptRow& attempt);

/// Shared settings of the campaign in `store`, the engine's hash left out.
JobSettings job_settings(const std::filesystem::path& root, const Store& store);

}  // namespace grouser
