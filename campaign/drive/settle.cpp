// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "campaign/drive/decide.hpp"

namespace grouser {
namespace {

constexpr const char* kStoppedReason = "stopped on request";

// What becomes of the run after an attempt.
enum class Next {
  kFinish,   ///< nothing more to do
  kAdvance,  ///< the chunk is done, the next one may start
  kRetry,    ///< the same chunk again
  kHold,
  kGiveUp,
  kCancel,
};

void record_outcome(AttemptRow& attempt, const Evidence& evidence) {
  if (!evidence.outcome) return;
  const Outcome& outcome = *evidence.outcome;
  attempt.has_outcome = true;
  attempt.step = outcome.step;
  attempt.time = outcome.time;
  attempt.steps_done = outcome.steps_done;
  attempt.particles = outcome.particles;
  attempt.ranks = outcome.ranks;
  attempt.threads = outcome.threads;
  attempt.wall_seconds = outcome.wall_seconds;
  attempt.compute_seconds = outcome.compute_seconds;
  attempt.checkpoint_seconds = outcome.checkpoint_seconds;
  attempt.slowest_checkpoint = outcome.slowest_checkpoint_seconds;
  attempt.checkpoint = outcome.checkpoint;
  attempt.state_hash = outcome.state_hash;
}

bool has_checkpoint_at_end(EngineCode code) {
  return code == EngineCode::kFinished || code == EngineCode::kPaused ||
         code == EngineCode::kSteady || code == EngineCode::kStopped;
}

// Where the run stands on disk, which is what a next attempt starts from.
void record_reached(RunRow& run, const Evidence& evidence) {
  if (evidence.outcome) {
    if (evidence.outcome->end_time > 0.0) run.end_time = evidence.outcome->end_time;
    if (evidence.outcome->particles > 0) run.particles = evidence.outcome->particles;
  }
  if (evidence.newest) {
    run.step = evidence.newest->step;
    run.time = evidence.newest->time;
    run.checkpoint = evidence.newest->file;
    run.state_hash = evidence.newest->state_hash;
  }
  // After a good end the outcome names the checkpoint of its own last step; the manifest of it may
  // not be visible here yet.
  if (evidence.outcome && !evidence.outcome->checkpoint.empty() &&
      has_checkpoint_at_end(evidence.outcome->code)) {
    run.step = evidence.outcome->step;
    run.time = evidence.outcome->time;
    run.checkpoint = evidence.outcome->checkpoint;
    run.state_hash = evidence.outcome->state_hash;
  }
}

bool has_reached_end(const ChunkRow& chunk, const RunRow& run) {
  return chunk.until_time && run.time >= *chunk.until_time;
}

Next next_of(OutcomeClass outcome_class, const RunRow& run, const Policy& policy) {
  if (outcome_class == OutcomeClass::kDone) return Next::kFinish;
  if (run.request == "cancel") return Next::kCancel;
  if (outcome_class == OutcomeClass::kContinue) return Next::kAdvance;
  if (run.request == "stop") return Next::kHold;
  if (outcome_class == OutcomeClass::kInfra || outcome_class == OutcomeClass::kPlumbing)
    return run.failures > policy.retries ? Next::kGiveUp : Next::kRetry;
  return Next::kHold;
}

// To go on without having moved is a failure like any other, or it would go on for ever.
OutcomeClass effective_class(const Ending& ending, const RunRow& run, const ChunkRow& chunk,
                             const AttemptRow& attempt) {
  const bool moved = run.step > attempt.start_step || has_reached_end(chunk, run);
  return ending.outcome_class == OutcomeClass::kContinue && !moved ? OutcomeClass::kPlumbing
                                                                   : ending.outcome_class;
}

// Progress starts the count afresh; a failure that brought none adds to it. An attempt that the
// scheduler never had says nothing about the run.
std::int64_t failures_after(const RunRow& run, const AttemptRow& attempt, const Ending& ending) {
  if (!ending.was_submitted) return run.failures;
  switch (ending.outcome_class) {
    case OutcomeClass::kInfra:
    case OutcomeClass::kPlumbing:
      return run.step > attempt.start_step ? 1 : run.failures + 1;
    case OutcomeClass::kContinue:
    case OutcomeClass::kDone:
      return 0;
    case OutcomeClass::kResource:
    case OutcomeClass::kPhysics:
    case OutcomeClass::kUser:
    case OutcomeClass::kDefect:
      break;
  }
  return run.failures;
}

double delay_of(const RunRow& run, const Policy& policy) {
  const auto doublings = static_cast<double>(std::max<std::int64_t>(run.failures - 1, 0));
  return std::min(policy.retry_delay * std::exp2(std::min(doublings, 16.0)), kLongestDelay);
}

// Asked to end and ended with a checkpoint: by a stop file, or by a signal that a person sent.
bool ended_in_order(const Ending& ending) {
  return ending.code == static_cast<int>(EngineCode::kStopped) ||
         (ending.code == static_cast<int>(EngineCode::kPaused) &&
          ending.outcome_class == OutcomeClass::kUser);
}

State attempt_state(const Ending& ending, Next next) {
  if (next == Next::kFinish)
    return ending.code == static_cast<int>(EngineCode::kSteady) ? State::kSteady
                                                                : State::kCompleted;
  if (next == Next::kCancel || !ending.was_submitted) return State::kCancelled;
  return next == Next::kAdvance || ended_in_order(ending) ? State::kChunkDone : State::kFailed;
}

void advance(Change& change, const RunRow& run) {
  ChunkRow& chunk = *change.chunk;
  chunk.state = State::kChunkDone;
  if (has_reached_end(chunk, run)) return;
  // Stopped by walltime on the way: the rest of the chunk becomes a chunk of its own.
  ChunkRow rest = chunk;
  rest.id = {};
  rest.position = chunk.position + 1;
  rest.state = State::kPlanned;
  change.chunk_after = rest;
}

// What the attempt's time came to. One that left no outcome occupied its job for as long as the
// manager saw it running, and its steps are taken as equally long.
void book(AttemptRow& attempt, const RunRow& run, double now) {
  const auto saved = static_cast<double>(std::max<std::int64_t>(run.step - attempt.start_step, 0));
  double computing = attempt.compute_seconds;
  attempt.hung_seconds = std::max(attempt.hung_seconds, 0.0);
  auto steps = static_cast<double>(attempt.steps_done);
  if (!attempt.has_outcome) {
    const double occupied =
        attempt.running_at > 0.0 ? std::max(now - attempt.running_at, 0.0) : 0.0;
    attempt.hung_seconds = std::min(attempt.hung_seconds, occupied);
    computing = occupied - attempt.hung_seconds;
    steps = static_cast<double>(attempt.progress_step - attempt.start_step);
  }
  attempt.useful_seconds = computing * std::min(saved / std::max({steps, saved, 1.0}), 1.0);
  attempt.lost_seconds = computing - attempt.useful_seconds;
}

void set_states(Change& change, Next next, const Ending& ending, const Policy& policy, double now) {
  RunRow& run = *change.run;
  ChunkRow& chunk = *change.chunk;
  const bool is_stopping = run.request == "stop";
  run.reason = ending.reason;
  switch (next) {
    case Next::kFinish:
      run.state = change.attempt->state;
      if (run.state == State::kCompleted) run.reason.clear();
      chunk.state = run.state;
      change.drop_planned_chunks = true;
      break;
    case Next::kAdvance:
      run.state = is_stopping ? State::kHeld : State::kChunkDone;
      run.reason = is_stopping ? kStoppedReason : "";
      advance(change, run);
      break;
    case Next::kRetry:
      run.state = State::kReady;
      chunk.state = State::kReady;
      run.not_before = ending.was_submitted ? now + delay_of(run, policy) : now;
      break;
    case Next::kHold:
      run.state = State::kHeld;
      chunk.state = State::kHeld;
      if (is_stopping) run.reason = kStoppedReason;
      break;
    case Next::kGiveUp:
      run.state = State::kFailed;
      chunk.state = State::kFailed;
      run.reason = std::to_string(run.failures) +
                   " attempts in a row without progress; last: " + ending.reason;
      break;
    case Next::kCancel:
      run.state = State::kCancelled;
      chunk.state = State::kCancelled;
      run.reason = "cancelled on request";
      break;
  }
  run.request.clear();
}

bool is_same_sight(const AttemptRow& a, const AttemptRow& b) {
  return a.state == b.state && a.job == b.job && a.reason == b.reason && a.absences == b.absences &&
         a.outcome_at == b.outcome_at && a.running_at == b.running_at && a.host == b.host &&
         a.progress_at == b.progress_at && a.hung_seconds == b.hung_seconds &&
         a.absent_since == b.absent_since;
}

}  // namespace

Change settle(const RunRow& run, const ChunkRow& chunk, const AttemptRow& attempt,
              const Ending& found, const Evidence& evidence, const Policy& policy, double now) {
  Change change{run, chunk, attempt, std::nullopt, false};
  record_outcome(*change.attempt, evidence);
  record_reached(*change.run, evidence);
  change.chunk->step = change.run->step;
  change.chunk->time = change.run->time;
  Ending ending = found;
  ending.outcome_class = effective_class(found, *change.run, chunk, attempt);
  change.run->failures = failures_after(*change.run, attempt, ending);
  const Next next = next_of(ending.outcome_class, *change.run, policy);
  change.attempt->state = attempt_state(ending, next);
  change.attempt->outcome_class = word_of(ending.outcome_class);
  change.attempt->code = ending.code;
  change.attempt->reason = ending.reason;
  change.attempt->ended_at = now;
  change.attempt->progress_step = std::max(change.attempt->progress_step, evidence.progress_step);
  book(*change.attempt, *change.run, now);
  set_states(change, next, ending, policy, now);
  return change;
}

std::optional<Change> consequence(const RunRow& run, const ChunkRow& chunk,
                                  const AttemptRow& attempt, const Sighting& sighting,
                                  const Evidence& evidence, const Policy& policy, double now) {
  if (sighting.ending)
    return settle(run, chunk, sighting.attempt, *sighting.ending, evidence, policy, now);
  if (is_same_sight(attempt, sighting.attempt)) return std::nullopt;
  Change change{run, chunk, sighting.attempt, std::nullopt, false};
  change.run->state = sighting.attempt.state;
  change.run->reason = sighting.attempt.reason;
  change.chunk->state = sighting.attempt.state;
  return change;
}

}  // namespace grouser
