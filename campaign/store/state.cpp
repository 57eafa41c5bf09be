// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/state.hpp"

#include <array>
#include <utility>

#include "base/errors.hpp"
#include "campaign/store/rows.hpp"

namespace grouser {
namespace {

constexpr std::array<std::pair<State, const char*>, 12> kWords{{
    {State::kPlanned, "PLANNED"},
    {State::kReady, "READY"},
    {State::kSubmitting, "SUBMITTING"},
    {State::kQueued, "QUEUED"},
    {State::kRunning, "RUNNING"},
    {State::kChunkDone, "CHUNK_DONE"},
    {State::kHeld, "HELD"},
    {State::kUnknown, "UNKNOWN"},
    {State::kSteady, "STEADY"},
    {State::kCompleted, "COMPLETED"},
    {State::kFailed, "FAILED"},
    {State::kCancelled, "CANCELLED"},
}};

}  // namespace

const char* word_of(State state) {
  for (const auto& [one, word] : kWords)
    if (one == state) return word;
  return "UNKNOWN";
}

State state_from(const std::string& word) {
  for (const auto& [state, one] : kWords)
    if (word == one) return state;
  throw FormatError("'" + word + "' is not a state of a run");
}

bool is_active(State state) {
  return state == State::kSubmitting || state == State::kQueued || state == State::kRunning ||
         state == State::kUnknown;
}

bool is_terminal(State state) {
  return state == State::kSteady || state == State::kCompleted || state == State::kFailed ||
         state == State::kCancelled;
}

const char* word_of(RunKind kind) { return kind == RunKind::kBed ? "bed" : "wheel"; }

}  // namespace grouser
