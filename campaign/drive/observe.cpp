// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/observe.hpp"

#include "campaign/drive/driver.hpp"

namespace grouser {
namespace {

// Files say that the engine is gone, but not yet all that a tick needs for its decision.
Observation ended_in_part(const RunRow& run, const Evidence& evidence) {
  Observation seen;
  seen.change.run = run;
  seen.change.run->reason = evidence.outcome ? "the engine has ended: " + evidence.outcome->reason
                                             : "the job has ended and left no outcome so far";
  seen.has_ended = true;
  seen.has_failed = !evidence.outcome;
  return seen;
}

std::optional<Observation> observe_one(const RunRow& run, const ChunkRow& chunk,
                                       const AttemptRow& attempt, const Evidence& evidence,
                                       const Policy& policy, double now) {
  const Sighting sighting = look(attempt, evidence, policy, now);
  const auto change = consequence(run, chunk, attempt, sighting, evidence, policy, now);
  if (!sighting.ending) {
    if (evidence.exit) return ended_in_part(run, evidence);
    return change ? std::optional(Observation{*change}) : std::nullopt;
  }
  Observation seen{*change, true, change->attempt->state == State::kFailed};
  // The database still has the attempt as active: the reader must learn what became of it.
  std::string& reason = seen.change.run->reason;
  if (seen.has_failed && !is_terminal(seen.change.run->state))
    reason = "attempt " + std::to_string(attempt.number) + ": " + change->attempt->reason;
  return seen;
}

// Without the scheduler's word only an end that files tell, or a beginning, is news.
bool is_told_by_files(const AttemptRow& attempt, const Evidence& evidence) {
  return evidence.outcome || evidence.exit ||
         (evidence.started && attempt.state != State::kRunning);
}

}  // namespace

std::vector<Observation> observe(const std::filesystem::path& root, const Store& store,
                                 Scheduler* scheduler, double now) {
  std::vector<Observation> seen;
  const auto active = store.active_attempts();
  if (active.empty()) return seen;
  const Settings settings = job_settings(root, store).settings;
  const Policy policy = policy_of(scheduler_kind(settings.scheduler), settings, {});
  QueryAnswer answer;
  if (scheduler != nullptr) answer = scheduler->query(keys_of(active));
  for (const AttemptRow& attempt : active) {
    const RunRow run = store.run(attempt.run);
    Evidence evidence = evidence_of(root, run, attempt, answer);
    if (scheduler == nullptr) {
      if (!is_told_by_files(attempt, evidence)) continue;
      if (!evidence.outcome && !evidence.exit) {
        evidence.job.emplace();
        evidence.job->phase = JobPhase::kRunning;
      }
    }
    const ChunkRow chunk = chunk_of(store, attempt);
    if (auto one = observe_one(run, chunk, attempt, evidence, policy, now))
      seen.push_back(std::move(*one));
  }
  return seen;
}

}  // namespace grouser
