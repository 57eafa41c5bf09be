// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/case.hpp"
#include "engine/dem/world.hpp"

namespace grouser {

/// Numbers of the bodies in a run's world.
inline constexpr std::size_t kBoxBody = 0;
inline constexpr std::size_t kWheelBody = 1;

/// A world with the case's box, and its wheel if it has one, but without grains.
/// The box walls reach above `box.depth` so that no grain can fall out: to the top of the loose
/// filling while a bed settles, by one wheel diameter while a wheel drives. Local.
/// @param threads of this rank
World make_world(const Communicator& ranks, const Case& input, int threads = 1);

/// Says the time step, what decided it and what is seldom meant. Local.
void log_time_step(const Case& input);

/// Fills the world's share of the random loose packing, or of the placed grains. Local.
void fill(World& world, const Case& input);

}  // namespace grouser
