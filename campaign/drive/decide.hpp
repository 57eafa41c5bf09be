// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "campaign/drive/evidence.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// Why an attempt ended, in the terms that decide what happens next.
enum class OutcomeClass {
  kDone,      ///< the run is finished
  kContinue,  ///< planned end, walltime, preemption: go on from the checkpoint
  kInfra,     ///< node, network, file system: try again, finitely often
  kResource,  ///< memory, quota, full file system: a person must make room
  kPhysics,   ///< the solution broke down: never tried again blindly
  kPlumbing,  ///< scheduler or manager; the run itself was not at fault
  kUser,      ///< somebody's wish or input
  kDefect,    ///< of the program
};

/// "DONE", "CONTINUE", ...
const char* word_of(OutcomeClass outcome_class);

/// Patience of the manager.
struct Policy {
  std::int64_t retries = 3;    ///< failures in a row without progress that are tried again
  double grace = 0.0;          ///< a job may be absent this long before it counts as gone [s]
  std::int64_t looks = 2;      ///< and at this many looks in a row
  std::int64_t end_looks = 1;  ///< looks at which an ended job may still lack its outcome
  double linger = 60.0;        ///< a job may live this long after its outcome [s]
  double hang = 0.0;           ///< a running job may stand still this long; 0 = for ever [s]
  double retry_delay = 0.0;    ///< before the first retry; doubles with each further one [s]
};

/// How an attempt ended.
struct Ending {
  OutcomeClass outcome_class = OutcomeClass::kInfra;
  std::optional<int> code;
  std::string reason;
  bool was_submitted = true;  ///< false: the scheduler never had it
};

/// What one look at an active attempt brought.
struct Sighting {
  AttemptRow attempt;            ///< with its state brought up to date
  std::optional<Ending> ending;  ///< if it is over
  bool must_cancel = false;      ///< its job lingers on after its outcome, or hangs
};

/// Judges an active attempt: the outcome file is believed first, then the scheduler, then the exit
/// code; a question that was not answered changes nothing. Pure.
Sighting look(const AttemptRow& attempt, const Evidence& evidence, const Policy& policy,
              double now);

/// What an ended attempt means for its run: the rows to be written, all at once. Pure.
Change settle(const RunRow& run, const ChunkRow& chunk, const AttemptRow& attempt,
              const Ending& ending, const Evidence& evidence, const Policy& policy, double now);

/// The rows that a sighting of `attempt` changes: what settle() says of one that is over, else its
/// new state; nothing when there is nothing new. Pure.
std::optional<Change> consequence(const RunRow& run, const ChunkRow& chunk,
                                  const AttemptRow& attempt, const Sighting& sighting,
                                  const Evidence& evidence, const Policy& policy, double now);

/// Seconds from `then` to `now` on the manager's clock; none when it was set back meanwhile. Pure.
double seconds_since(double then, double now);

/// Longest time before a retry [s].
inline constexpr double kLongestDelay = 3600.0;

/// The class of an engine's exit code. Pure.
OutcomeClass class_of(EngineCode code);

}  // namespace grouser
