// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "base/case.hpp"
#include "engine/core/particle.hpp"
#include "engine/dem/body.hpp"

namespace grouser::bench {

/// Writes the drum of the case's diameter and width as STL of 1 728 well-shaped facets, its axle
/// the y axis through the origin. (The engine's own drum is made of slivers as long as the wheel is
/// wide, which not every code takes.)
void write_wheel(const std::filesystem::path& file, const Case& input);

/// Where the wheel starts, sunk by a quarter of its diameter, and its prescribed motion.
/// @param surface height of the undisturbed bed [m]
BodyMotion wheel_motion(const Case& input, double surface);

/// The same as left in the peers' parameters.
BodyMotion read_wheel_motion(const std::filesystem::path& file);

/// Takes out the grains that the wheel at `axle` overlaps; the others get new ids.
void remove_under_wheel(std::vector<Particle>& grains, const Case& input, const Vec3& axle);

}  // namespace grouser::bench
