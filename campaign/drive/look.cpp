// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "campaign/drive/decide.hpp"

namespace grouser {
namespace {

constexpr std::array<std::pair<EngineCode, OutcomeClass>, 11> kCodeClasses{{
    {EngineCode::kFinished, OutcomeClass::kDone},
    {EngineCode::kPaused, OutcomeClass::kContinue},
    {EngineCode::kSteady, OutcomeClass::kDone},
    {EngineCode::kStopped, OutcomeClass::kUser},
    {EngineCode::kInputRefused, OutcomeClass::kUser},
    {EngineCode::kCheckpointRefused, OutcomeClass::kResource},
    {EngineCode::kFenceLost, OutcomeClass::kPlumbing},
    {EngineCode::kBrokeDown, OutcomeClass::kPhysics},
    {EngineCode::kStorageFailed, OutcomeClass::kResource},
    {EngineCode::kParallelFailed, OutcomeClass::kInfra},
    {EngineCode::kDefect, OutcomeClass::kDefect},
}};

// An absent job that said it had begun gets this many times the grace: it may still be running.
constexpr double kStartedPatience = 3.0;

// A job that seems to hang is looked at again this much later [s].
constexpr double kHangConfirmed = 30.0;

// Exit codes of a shell that could not start the program.
constexpr int kNotExecutable = 126;
constexpr int kNotFound = 127;

// A shell reports a child's death by a signal as this plus the signal's number.
constexpr int kSignalBase = 128;

std::optional<EngineCode> engine_code(int number) {
  for (const auto& [code, unused] : kCodeClasses)
    if (static_cast<int>(code) == number) return code;
  return std::nullopt;
}

// The job died without the engine's last word; only its exit code speaks.
Ending ending_by_code(int code) {
  const std::string text =
      code > kSignalBase && code < kSignalBase + 65
          ? "killed by signal " + std::to_string(code - kSignalBase) + ", no outcome"
          : "exit code " + std::to_string(code) + " and no outcome";
  if (code == kNotFound || code == kNotExecutable)
    return {
        OutcomeClass::kUser, code,
        "the engine or its launcher could not be started (" + text + "); see the attempt's log"};
  const auto known = engine_code(code);
  // An engine that ends well leaves an outcome; without it these codes are not believed.
  const OutcomeClass by_code = known ? class_of(*known) : OutcomeClass::kInfra;
  const bool is_good = by_code == OutcomeClass::kDone || by_code == OutcomeClass::kContinue ||
                       (known && *known == EngineCode::kStopped);
  return {is_good ? OutcomeClass::kInfra : by_code, code, text};
}

Ending ending_by_job(const JobStatus& job, const std::optional<JobRecord>& exit) {
  std::optional<int> code;
  if (job.exit_code >= 0) code = job.exit_code;
  const std::string detail = job.detail.empty() ? "" : " (" + job.detail + ")";
  switch (job.end) {
    case JobEnd::kTimeout:
      return {OutcomeClass::kInfra, code, "killed at its walltime without an outcome" + detail};
    case JobEnd::kPreempted:
      return {OutcomeClass::kContinue, code, "preempted" + detail};
    case JobEnd::kNodeFailed:
      return {OutcomeClass::kInfra, code, "the node failed" + detail};
    case JobEnd::kOutOfMemory:
      return {OutcomeClass::kResource, code, "out of memory" + detail};
    case JobEnd::kCancelled:
      return {OutcomeClass::kUser, code, "the job was cancelled" + detail};
    case JobEnd::kDrained:
      return {OutcomeClass::kInfra, code, "the job was ended by an administrator" + detail};
    case JobEnd::kKilled:
    case JobEnd::kDone:
    case JobEnd::kFailed:
    case JobEnd::kNone:
      break;
  }
  if (exit) return ending_by_code(exit->code);
  if (job.end == JobEnd::kFailed && job.exit_code >= 0) return ending_by_code(job.exit_code);
  return {OutcomeClass::kInfra, code, "ended without an outcome" + detail};
}

Ending ending_by_outcome(const Outcome& outcome, const Evidence& evidence) {
  Ending ending{class_of(outcome.code), static_cast<int>(outcome.code), outcome.reason};
  // A signal is the batch system's (walltime, preemption) unless that says that a person sent it.
  const bool was_cancelled = outcome.code == EngineCode::kPaused && outcome.by_signal &&
                             evidence.job && evidence.job->end == JobEnd::kCancelled;
  if (!was_cancelled) return ending;
  ending.outcome_class = OutcomeClass::kUser;
  ending.reason = "the job was cancelled (" + evidence.job->detail + ")";
  return ending;
}

bool job_has_ended(const Evidence& evidence) {
  return evidence.job && evidence.job->phase == JobPhase::kEnded;
}

bool is_absent(const Evidence& evidence) { return evidence.scheduler_answered && !evidence.job; }

// An outcome is there. The attempt is over when its job is, too.
Sighting look_at_outcome(AttemptRow attempt, const Evidence& evidence, const Policy& policy,
                         double now) {
  Sighting sighting;
  attempt.state = State::kRunning;
  attempt.reason.clear();
  if (attempt.outcome_at == 0.0) attempt.outcome_at = now;
  // Whether a signal came from the batch system or from a person, only the scheduler knows.
  const bool script_ended = evidence.exit.has_value() && !evidence.outcome->by_signal;
  if (now < attempt.outcome_at) attempt.outcome_at = now;  // the clock was set back
  const bool lingers = now - attempt.outcome_at >= policy.linger;
  const bool is_over = script_ended || job_has_ended(evidence) || is_absent(evidence);
  sighting.attempt = attempt;
  sighting.must_cancel = lingers && !is_over && !evidence.exit;
  if (is_over || lingers) sighting.ending = ending_by_outcome(*evidence.outcome, evidence);
  return sighting;
}

// One more look at which it seemed over; true when that is enough.
bool count_absence(AttemptRow& attempt, const Evidence& evidence, double now, double grace,
                   std::int64_t looks) {
  if (attempt.absences == 0 || now < attempt.absent_since) {
    attempt.absences = 0;
    attempt.absent_since = now;
    attempt.absent_step = evidence.progress_step;
  }
  ++attempt.absences;
  return attempt.absences >= looks && now - attempt.absent_since >= grace;
}

Sighting look_at_absence(AttemptRow attempt, const Evidence& evidence, const Policy& policy,
                         double now) {
  if (attempt.absences > 0 && evidence.progress_step > attempt.absent_step) {
    // Whatever the scheduler says, the run moves on.
    attempt.absences = 0;
    attempt.state = State::kRunning;
    attempt.reason = "the scheduler does not know the job, but the run advances";
    return {attempt, std::nullopt};
  }
  const bool was_submitted = !attempt.job.empty();
  const double grace = policy.grace * (evidence.started ? kStartedPatience : 1.0);
  const bool is_gone = count_absence(attempt, evidence, now, grace, policy.looks);
  attempt.state = was_submitted ? State::kUnknown : State::kSubmitting;
  attempt.reason = "the scheduler does not know the job";
  if (!is_gone) return {attempt, std::nullopt};
  if (was_submitted) return {attempt, Ending{OutcomeClass::kInfra, {}, "the job is gone"}};
  Ending ending{OutcomeClass::kPlumbing, {}, "the job never reached the scheduler"};
  ending.was_submitted = false;
  return {attempt, ending};
}

// Writing down every step seen would be much writing; often enough is a small part of the patience.
void note_progress(AttemptRow& attempt, const Evidence& evidence, const Policy& policy,
                   double now) {
  constexpr double kPart = 0.125;
  const double known_for = seconds_since(attempt.progress_at, now);
  if (attempt.progress_at == 0.0 || now < attempt.progress_at ||
      (evidence.progress_step != attempt.progress_step && known_for >= kPart * policy.hang)) {
    attempt.progress_step = evidence.progress_step;
    attempt.progress_at = now;
  }
}

// The job is alive as far as the scheduler knows.
Sighting look_at_alive(AttemptRow attempt, const Evidence& evidence, const Policy& policy,
                       double now) {
  attempt.state = evidence.job->phase == JobPhase::kQueued ? State::kQueued : State::kRunning;
  attempt.absences = 0;
  attempt.reason = attempt.state == State::kQueued ? evidence.job->detail : "";
  Sighting sighting{attempt, std::nullopt};
  // One that waits, or that was suspended, cannot advance.
  if (attempt.state == State::kQueued || evidence.job->detail.rfind("SUSPENDED", 0) == 0) {
    sighting.attempt.progress_at = 0.0;
    return sighting;
  }
  if (policy.hang <= 0.0) return sighting;
  note_progress(sighting.attempt, evidence, policy, now);
  const double still = evidence.progress_step == sighting.attempt.progress_step
                           ? seconds_since(sighting.attempt.progress_at, now)
                           : 0.0;
  const bool has_stepped = evidence.progress_step > 0;
  AttemptRow& seen = sighting.attempt;
  if (still < policy.hang * (has_stepped ? 1.0 : kStartedPatience)) {
    seen.hung_seconds = 0.0;
    return sighting;
  }
  // A machine that slept, manager and all, looks the same at first: it is asked once more before
  // the job is killed. The suspicion is kept with a minus sign.
  if (seen.hung_seconds == 0.0) {
    seen.hung_seconds = -still;
    return sighting;
  }
  if (seen.hung_seconds < 0.0 && still < -seen.hung_seconds + kHangConfirmed) return sighting;
  seen.hung_seconds = still;
  seen.reason =
      "no step for " + std::to_string(std::llround(still)) + " s: the job hangs and is killed";
  sighting.must_cancel = true;
  return sighting;
}

Sighting look_at_ended(AttemptRow attempt, const Evidence& evidence, const Policy& policy,
                       double now) {
  const Ending ending = job_has_ended(evidence) ? ending_by_job(*evidence.job, evidence.exit)
                                                : ending_by_code(evidence.exit->code);
  // On a shared file system the outcome may become visible after the end of the job does.
  if (!count_absence(attempt, evidence, now, 0.0, policy.end_looks)) return {attempt, std::nullopt};
  if (attempt.hung_seconds > 0.0)
    return {attempt,
            Ending{OutcomeClass::kInfra, ending.code,
                   "made no step for " + std::to_string(std::llround(attempt.hung_seconds)) +
                       " s and was killed (limits.hang)"}};
  return {attempt, ending};
}

// Tx2 was lost: the job is there all the same.
void adopt(AttemptRow& attempt, const Evidence& evidence, double now) {
  if (!attempt.job.empty()) return;
  if (evidence.job) attempt.job = evidence.job->id;
  if (attempt.job.empty() && evidence.started) attempt.job = evidence.started->job;
  if (!attempt.job.empty()) attempt.submitted_at = now;
}

}  // namespace

double seconds_since(double then, double now) { return std::max(now - then, 0.0); }

const char* word_of(OutcomeClass outcome_class) {
  switch (outcome_class) {
    case OutcomeClass::kDone:
      return "DONE";
    case OutcomeClass::kContinue:
      return "CONTINUE";
    case OutcomeClass::kInfra:
      return "INFRA";
    case OutcomeClass::kResource:
      return "RESOURCE";
    case OutcomeClass::kPhysics:
      return "PHYSICS";
    case OutcomeClass::kPlumbing:
      return "PLUMBING";
    case OutcomeClass::kUser:
      return "USER";
    case OutcomeClass::kDefect:
      break;
  }
  return "DEFECT";
}

OutcomeClass class_of(EngineCode code) {
  for (const auto& [one, outcome_class] : kCodeClasses)
    if (one == code) return outcome_class;
  return OutcomeClass::kDefect;
}

Sighting look(const AttemptRow& before, const Evidence& evidence, const Policy& policy,
              double now) {
  AttemptRow attempt = before;
  adopt(attempt, evidence, now);
  const bool has_begun =
      evidence.started || (evidence.job && evidence.job->phase != JobPhase::kQueued);
  if (has_begun && attempt.running_at == 0.0) attempt.running_at = now;
  if (evidence.started && attempt.host.empty()) attempt.host = evidence.started->host;
  // The scheduler started it over, or will: what an earlier life of the job left is no end.
  if (evidence.job && evidence.job->phase == JobPhase::kQueued)
    return look_at_alive(attempt, evidence, policy, now);
  if (evidence.outcome) return look_at_outcome(attempt, evidence, policy, now);
  if (job_has_ended(evidence) || evidence.exit)
    return look_at_ended(attempt, evidence, policy, now);
  if (evidence.job) return look_at_alive(attempt, evidence, policy, now);
  if (is_absent(evidence)) return look_at_absence(attempt, evidence, policy, now);
  attempt.state = attempt.job.empty() ? State::kSubmitting : State::kUnknown;
  attempt.reason = "cannot ask the scheduler: " + evidence.why_not_answered;
  return {attempt, std::nullopt};
}

}  // namespace grouser
