// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>

#include "engine/coupling/resolved_flow.hpp"
#include "engine/dem/world.hpp"

namespace grouser {

/// Writes fluid_STEP.vtkhdf: velocity and pressure beyond that of the fluid at rest in every
/// cell, those inside grains too. The same on any number of ranks. @throws StorageError on every
/// rank. Collective.
void write_fluid_snapshot(const Communicator& ranks, const ResolvedFlow& fluid,
                          const std::filesystem::path& directory, std::int64_t step, double time);

/// Writes grains_STEP.vtkhdf, sorted by id and so the same on any number of ranks, with radius,
/// velocity, spin and displacement since the start of the run; and NAME_STEP.vtkhdf with the
/// surface of every body that turns. @throws StorageError on every rank. Collective.
void write_snapshot(const World& world, const std::filesystem::path& directory, std::int64_t step,
                    double time);

}  // namespace grouser
