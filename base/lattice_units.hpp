// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/case.hpp"

namespace grouser {

/// Between SI and lattice units (suffix _lu: cells, steps, density of the fluid at rest 1). The one
/// place where they are turned into each other.
struct LatticeUnits {
  double cell = 1.0;     ///< [m]
  double step = 1.0;     ///< [s]
  double density = 1.0;  ///< of the fluid at rest [kg m-3]

  double velocity_lu(double si) const { return si * step / cell; }
  double velocity(double lu) const { return lu * cell / step; }
  double viscosity_lu(double kinematic) const { return kinematic * step / (cell * cell); }
  double acceleration_lu(double si) const { return si * step * step / cell; }
  double spin_lu(double si) const { return si * step; }
  /// Force per step [N]. @param lu momentum per step
  double force(double lu) const { return lu * density * cell * cell * cell * cell / (step * step); }
  double moment(double lu) const { return force(lu) * cell; }
  /// Pressure beyond that of the fluid at rest [Pa].
  double pressure(double density_lu) const {
    return (density_lu - 1.0) / 3.0 * density * cell * cell / (step * step);
  }
  double density_lu(double pressure) const {
    return 1.0 + 3.0 * pressure * step * step / (density * cell * cell);
  }
};

/// What follows from a case's lattice.
struct LatticeScale {
  LatticeUnits units;
  std::array<std::int64_t, 3> cells{};  ///< along x, y, z
  std::int64_t substeps = 1;            ///< steps of the grains in one of the lattice
  double viscosity_lu = 0.0;
  double relaxation_time = 0.0;
  double mach = 0.0;            ///< of the speed expected, or of what is known without
  double grid_reynolds = 0.0;   ///< of a cell at that speed
  double smallest_grain = 0.0;  ///< diameter over cell; 0 without grains
};

/// Whether a case has a lattice. Local.
bool has_lattice(const Case& input);

/// Of a case with a lattice. @param longest  step that its grains could have without [s]. Local.
LatticeScale lattice_scale(const Case& input, double longest);

/// Below so many cells to its diameter a grain is not resolved.
inline constexpr double kLeastCellsPerGrain = 5.0;
inline constexpr double kGoodCellsPerGrain = 8.0;
/// Grains lighter than this share of the fluid's density have not enough inertia of their own.
inline constexpr double kLightestGrain = 0.6;
/// Over this Mach number the quadratic equilibrium is no more the Navier-Stokes equations.
inline constexpr double kMostMach = 0.3;

/// One line for people: cells, steps, numbers, and how far results may be off. Local.
std::string lattice_text(const Case& input);

/// Rules over the lattice of a case; see FieldVisitor.
void describe_lattice(FieldVisitor& visitor, const Case& input);

/// What is allowed but seldom meant, at its place in `node`. Local.
std::vector<Problem> lattice_warnings(const YamlNode& node, const Case& input);

}  // namespace grouser
