// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "campaign/store/store.hpp"

namespace grouser {

/// What a person may want of runs.
enum class Wish {
  kStop,              ///< end in order with a checkpoint, then be held
  kCancel,            ///< end now
  kResume,            ///< go on after HELD, FAILED or CANCELLED
  kResumeWithEngine,  ///< and with the engine as it is now, whatever computed the state so far
};

/// Writes a wish down; the next ticks carry it out where a job is active. Needs the lease.
/// @return whether the wish means anything to the run as it stands
bool make_wish(Store& store, const RunRow& run, Wish wish, double now);

}  // namespace grouser
