// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/wishes.hpp"

namespace grouser {
namespace {

// The first chunk that is not done; a run that is not finished always has one.
std::optional<ChunkRow> open_chunk(const Store& store, RunId run) {
  for (const ChunkRow& chunk : store.chunks(run))
    if (chunk.state != State::kChunkDone && chunk.state != State::kCompleted &&
        chunk.state != State::kSteady)
      return chunk;
  return std::nullopt;
}

void put_state(Store& store, RunRow run, State state, const std::string& reason) {
  run.state = state;
  run.reason = reason;
  run.request.clear();
  Change change;
  change.run = run;
  change.chunk = open_chunk(store, run.id);
  if (change.chunk) change.chunk->state = state == State::kReady ? State::kPlanned : state;
  store.apply(change);
}

bool resume(Store& store, RunRow run) {
  if (run.state != State::kHeld && run.state != State::kFailed && run.state != State::kCancelled)
    return false;
  run.failures = 0;
  run.not_before = 0.0;
  // A wheel run may still have to wait for its bed, and the bed for a person.
  put_state(store, run, run.bed ? State::kPlanned : State::kReady, "");
  return true;
}

}  // namespace

bool make_wish(Store& store, const RunRow& run, Wish wish, double now) {
  if (wish == Wish::kResume) return resume(store, run);
  if (wish == Wish::kResumeWithEngine) {
    RunRow freed = run;
    freed.engine_hash.clear();
    return resume(store, freed);
  }
  const bool is_stop = wish == Wish::kStop;
  if (is_active(run.state)) {
    RunRow asked = run;
    asked.request = is_stop ? "stop" : "cancel";
    asked.requested_at = now;
    Change change;
    change.run = asked;
    store.apply(change);
    return true;
  }
  if (is_terminal(run.state) || (is_stop && run.state == State::kHeld)) return false;
  put_state(store, run, is_stop ? State::kHeld : State::kCancelled,
            is_stop ? "stopped on request" : "cancelled on request");
  return true;
}

}  // namespace grouser
