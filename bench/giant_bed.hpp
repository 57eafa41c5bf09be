// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "base/case.hpp"
#include "engine/core/communicator.hpp"
#include "engine/core/particle.hpp"

namespace grouser::bench {

/// What becomes of a bed laid side by side with its mirror images until it is very large.
struct GiantOptions {
  std::filesystem::path directory;  ///< of the bed, as left by export
  std::filesystem::path room;       ///< where its checkpoint is written
  int tiles_x = 1;
  int tiles_y = 1;
  std::int64_t steps = 0;
  double time_step = 0.0;  ///< [s]
  double skin = 0.0;       ///< [m]
  bool rolls = false;
};

/// Steps the giant bed, writes a checkpoint, restarts from it in a new world, steps both on and
/// compares their states; prints one line of JSON. Mirror images touch where the bed touched its
/// walls, so the giant is at rest as the bed was. Collective.
void run_giant(const Communicator& ranks, Case input, const std::vector<Particle>& bed,
               const GiantOptions& options);

}  // namespace grouser::bench
