// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/lattice_case.hpp"
#include "base/schema.hpp"

namespace grouser {

/// One force of the fluid: which law, and how much of it. An amplitude of 0 leaves the trajectory's
/// bits as they are without the force; 1 is the law as published.
struct TermCase {
  std::string law;
  double amplitude = 0.0;  ///< [1]
};

/// The fluid around the grains: docs/physics/fluid_forces.md.
struct FluidCase {
  /// "submerged": the grains do not move the fluid; "resolved": it is computed around each of them
  /// on a lattice, and of the terms below buoyancy alone counts
  std::string mode = "submerged";
  bool has_lattice = false;
  LatticeCase lattice;
  double density = 0.0;        ///< [kg m-3]
  double viscosity = 0.0;      ///< dynamic [Pa s]
  double velocity_x = 0.0;     ///< at the floor [m s-1]
  double velocity_y = 0.0;     ///< [m s-1]
  double velocity_z = 0.0;     ///< [m s-1]
  double shear_rate = 0.0;     ///< of the velocity along x over the height [s-1]
  double void_fraction = 1.0;  ///< around every grain [1]
  TermCase drag{"schiller_naumann", 1.0};
  TermCase buoyancy{"", 1.0};
  TermCase added_mass{"sphere"};
  TermCase history{"basset"};
  TermCase shear_lift{"saffman_mei"};
  TermCase spin_lift{"rubinow_keller"};
  TermCase spin_drag{"kirchhoff"};
  TermCase lubrication{"brenner"};
  double smallest_gap = 1e-3;  ///< of lubrication, over the radius [1]
  double cutoff_gap = 1.0;     ///< of lubrication, over the radius [1]
  TermCase wall{"none", 1.0};
  double wall_diameter = 0.0;  ///< of the container [m]
};

/// See FieldVisitor.
void describe(FieldVisitor& visitor, FluidCase& fluid);

/// Time in which Stokes' drag changes the speed of a grain of the fluid [s]: mass, its added mass
/// included, over 3 pi mu d. @param diameter [m] @param density of the grain [kg m-3]. Local.
double drag_time(const FluidCase& fluid, double diameter, double density);

}  // namespace grouser
