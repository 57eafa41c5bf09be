// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace grouser {

/// Where a run, chunk or attempt stands. The words are fixed: they appear in the database, in
/// `--json` and in the docs.
enum class State {
  kPlanned,     ///< waits for its bed or for the chunk before it
  kReady,       ///< may be submitted
  kSubmitting,  ///< written down before the scheduler was asked; whether it has the job is open
  kQueued,      ///< the scheduler has the job
  kRunning,
  kChunkDone,  ///< ended with a complete checkpoint, more to do
  kHeld,       ///< needs a person; the reason says why, `resume` goes on
  kUnknown,    ///< the scheduler cannot be asked or does not know the job; nothing is assumed
  kSteady,     ///< ended because a steady state was reached
  kCompleted,
  kFailed,  ///< finite retries are used up, or the attempt ended without a usable result
  kCancelled,
};

/// "PLANNED", "READY", ... Local.
const char* word_of(State state);

/// @throws FormatError when `word` is no state. Local.
State state_from(const std::string& word);

/// Whether a job may exist for an attempt in this state; a run has at most one such attempt.
bool is_active(State state);

/// Whether a run in this state has ended for good unless a person resumes it.
bool is_terminal(State state);

}  // namespace grouser
