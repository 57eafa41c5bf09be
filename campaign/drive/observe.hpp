// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "campaign/drive/decide.hpp"
#include "campaign/store/store.hpp"
#include "schedulers/scheduler.hpp"

namespace grouser {

/// What a look at one active attempt found and no tick has written down yet.
struct Observation {
  Change change;            ///< the rows as a tick would write them now; `run` is always there
  bool has_ended = false;   ///< nothing of the attempt is at work any more
  bool has_failed = false;  ///< and not in order: killed, broken down, or without a last word
};

/// Looks at every active attempt as a tick does and writes nothing.
/// @param scheduler  asked where the jobs are; nullptr: the files of the run directories alone
///                   speak, and what they leave open stays as it was written down
/// @return attempts that are not as the database has them. Local, but for the scheduler.
std::vector<Observation> observe(const std::filesystem::path& root, const Store& store,
                                 Scheduler* scheduler, double now);

}  // namespace grouser
