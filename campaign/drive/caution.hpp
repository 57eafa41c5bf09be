// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/plan/campaign_file.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

// Reasons not to submit, or not as before: so that a bad node, a bad checkpoint, another engine or
// a chain that runs away costs little.

/// Hosts on which two or more of the attempts failed for reasons of infrastructure, without
/// progress, and none got on. Pure.
/// @param ended  last first
std::vector<std::string> bad_hosts(const std::vector<AttemptRow>& ended);

/// When the next job may be submitted after `ended` (last first): the latest three all having
/// failed within two minutes of their start for reasons of infrastructure, ten minutes after the
/// last; else 0. Pure. [s]
double pause_end(const std::vector<AttemptRow>& ended);

/// Whether the checkpoint that the run would go on from is likely to kill the engine: its last two
/// attempts both began at `run.step`, made no step and died without a word. Pure.
bool is_checkpoint_suspect(const RunRow& run, const std::vector<AttemptRow>& attempts);

/// Sets the newest checkpoint aside as NAME.bad, so that engines pass it over, if there is another.
/// @return the row of the run that stands at the one before; `run` itself when there is none.
/// @throws StorageError. Local.
RunRow set_aside_newest(const std::filesystem::path& root, const RunRow& run);

/// Why the limits forbid another job of the run; "" when they do not. Pure.
/// @param jobs      of the run so far
/// @param used      seconds that all ended jobs of the campaign took
/// @param active    jobs at work, each taken at its whole walltime
std::string limit_reached(const Settings& settings, std::size_t jobs, double used,
                          std::size_t active);

/// Why the engine's program may not go on with the run's state; "" when it may. Pure.
std::string engine_mismatch(const RunRow& run, const std::string& engine_hash);

}  // namespace grouser
