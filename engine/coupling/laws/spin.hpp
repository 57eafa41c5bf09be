// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "engine/coupling/fluid.hpp"

namespace grouser {

/// Lift of a spinning grain (Magnus): pi/8 rho d^3 W x (v - u) times a law's share, W the grain's
/// spin beyond the fluid's [N]. Topspin pushes a ball that flies forward downwards.
/// `share(reynolds, spin_ratio)`, spin_ratio = d |W| / (2 |u - v|).
template <class Law>
Vec3 spin_lift(const FluidPoint& at) {
  const Vec3 spin = at.relative_spin();
  const double speed = norm(at.slip);
  if (speed == 0.0) return {};
  const double ratio = 0.5 * at.diameter * norm(spin) / speed;
  if (ratio == 0.0) return {};
  const double size = 0.125 * std::numbers::pi * at.fluid.density * at.diameter * at.diameter *
                      at.diameter * Law::share(at.reynolds(), ratio);
  return size * cross(at.slip, spin);
}

/// Reynolds numbers below 1.
struct RubinowKellerLift {
  static constexpr const char* kName = "rubinow_keller";
  static constexpr const char* kSource = "Rubinow and Keller 1961";
  static double share(double /*reynolds*/, double /*spin_ratio*/) { return 1.0; }
  static Vec3 force(const FluidPoint& at) { return spin_lift<RubinowKellerLift>(at); }
};

/// Measured for Reynolds numbers of 10 to 140 and spin ratios of 1 to 6; turns into Rubinow and
/// Keller's towards Re = 0.
struct OesterleLift {
  static constexpr const char* kName = "oesterle";
  static constexpr const char* kSource = "Oesterle and Bui Dinh 1998";
  static double share(double reynolds, double spin_ratio) {
    // The lift coefficient over that of Rubinow and Keller, 2 spin_ratio.
    const double decay =
        std::exp(-0.05684 * std::pow(2.0 * spin_ratio * reynolds, 0.4) * std::pow(reynolds, 0.3));
    return (0.45 + (2.0 * spin_ratio - 0.45) * decay) / (2.0 * spin_ratio);
  }
  static Vec3 force(const FluidPoint& at) { return spin_lift<OesterleLift>(at); }
};

/// Torque of the fluid on a grain, pi mu d^3 (w/2 - spin) times a law's factor [N m], w the
/// vorticity. `factor(rotation)`, rotation = rho d^2 |W| / mu.
template <class Law>
double spin_drag_coefficient(const FluidPoint& at) {
  const double d2 = at.diameter * at.diameter;
  const double rotation = at.fluid.density * d2 * norm(at.relative_spin()) / at.fluid.viscosity;
  return std::numbers::pi * at.fluid.viscosity * d2 * at.diameter * Law::factor(rotation);
}

/// Creeping flow.
struct KirchhoffSpinDrag {
  static constexpr const char* kName = "kirchhoff";
  static constexpr const char* kSource = "Kirchhoff 1876; Lamb 1932, art. 334";
  static double factor(double /*rotation*/) { return 1.0; }
  static double coefficient(const FluidPoint& at) {
    return spin_drag_coefficient<KirchhoffSpinDrag>(at);
  }
};

/// Computed for rotation numbers of 32 to 1000: torque 1/2 rho (d/2)^5 W^2 (12.9/sqrt(R) +
/// 128.4/R), R the rotation number; creeping below, where both agree to 0.2 %.
struct DennisSpinDrag {
  static constexpr const char* kName = "dennis";
  static constexpr const char* kSource = "Dennis, Singh, Ingham 1980";
  static double factor(double rotation) {
    if (rotation <= 32.0) return 1.0;
    return (12.9 * std::sqrt(rotation) + 128.4) / (64.0 * std::numbers::pi);
  }
  static double coefficient(const FluidPoint& at) {
    return spin_drag_coefficient<DennisSpinDrag>(at);
  }
};

}  // namespace grouser
