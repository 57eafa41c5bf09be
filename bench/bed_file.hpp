// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "base/case.hpp"
#include "engine/core/particle.hpp"

namespace grouser::bench {

/// Grains as text, one a line: id x y z vx vy vz wx wy wz radius, SI, read back to the same bits.
void write_bed(const std::filesystem::path& file, const std::vector<Particle>& grains);

/// @param density of the solid [kg m-3]
/// @throws FormatError when a line is not a grain or ids are not 0 ... N-1 in order
std::vector<Particle> read_bed(const std::filesystem::path& file, double density);

/// Gives grains the positions, velocities and spins of `file`: rows as above, in any order, radius
/// not needed; ids that count from 1 are the peers'. Lines of fewer numbers are passed over.
/// @throws FormatError unless every grain has its row
void read_motion(const std::filesystem::path& file, std::vector<Particle>& grains);

/// The same grains, at rest, for read_data of LAMMPS and LIGGGHTS (atom style sphere); ids from 1.
void write_data_file(const std::filesystem::path& file, const Case& input,
                     const std::vector<Particle>& grains);

}  // namespace grouser::bench
