// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "engine/coupling/fluid.hpp"

namespace grouser {

/// Lift of a grain that moves through sheared fluid, 1.615 d^2 sqrt(rho mu / |w|) (u - v) x w times
/// a law's correction, w the vorticity [N]: a grain that lags behind is pushed towards the faster
/// fluid. `correction(reynolds, shear)`, shear = |w| d / (2 |u - v|).
template <class Law>
Vec3 shear_lift(const FluidPoint& at) {
  const double vorticity = norm(at.vorticity);
  const double speed = norm(at.slip);
  if (vorticity == 0.0 || speed == 0.0) return {};
  const double size = 1.615 * at.diameter * at.diameter *
                      std::sqrt(at.fluid.density * at.fluid.viscosity / vorticity);
  const double shear = 0.5 * vorticity * at.diameter / speed;
  return size * Law::correction(at.reynolds(), shear) * cross(at.slip, at.vorticity);
}

/// Small Reynolds numbers, of slip and of shear, the former much below the root of the latter.
struct SaffmanLift {
  static constexpr const char* kName = "saffman";
  static constexpr const char* kSource = "Saffman 1965 and 1968 (corrigendum)";
  static double correction(double /*reynolds*/, double /*shear*/) { return 1.0; }
  static Vec3 force(const FluidPoint& at) { return shear_lift<SaffmanLift>(at); }
};

/// Saffman's lift over Reynolds numbers up to 100, shear from 0.005 to 0.4.
struct SaffmanMeiLift {
  static constexpr const char* kName = "saffman_mei";
  static constexpr const char* kSource =
      "Mei 1992, fit to Dandy and Dwyer 1990 and McLaughlin 1991";
  static double correction(double reynolds, double shear) {
    const double root = 0.3314 * std::sqrt(shear);
    if (reynolds <= 40.0) return (1.0 - root) * std::exp(-0.1 * reynolds) + root;
    return 0.0524 * std::sqrt(shear * reynolds);
  }
  static Vec3 force(const FluidPoint& at) { return shear_lift<SaffmanMeiLift>(at); }
};

}  // namespace grouser
