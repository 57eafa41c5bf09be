// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "base/vec3.hpp"

namespace grouser {

/// A Newtonian fluid of constant density [kg m-3] and dynamic viscosity [Pa s].
struct Fluid {
  double density = 0.0;
  double viscosity = 0.0;

  /// rho d |u| / mu of a grain of diameter d [m] at speed |u| relative to the fluid [m s-1].
  double reynolds(double diameter, double speed) const {
    return density * diameter * speed / viscosity;
  }
};

/// The undisturbed fluid where a grain is, and the grain in it, as laws get it.
struct FluidPoint {
  Fluid fluid;
  double diameter = 0.0;       ///< of the grain [m]
  Vec3 slip;                   ///< of the fluid past the grain, u - v [m s-1]
  Vec3 vorticity;              ///< curl of the fluid's velocity [s-1]
  Vec3 spin;                   ///< of the grain [rad s-1]
  double void_fraction = 1.0;  ///< of the fluid around it [1]

  double reynolds() const { return fluid.reynolds(diameter, norm(slip)); }
  double volume() const { return std::numbers::pi / 6.0 * diameter * diameter * diameter; }
  /// Spin of the grain beyond that of the fluid [rad s-1].
  Vec3 relative_spin() const { return spin - 0.5 * vorticity; }
};

}  // namespace grouser
