// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// Added (virtual) mass: the fluid that must be accelerated with a grain, as a share C of the fluid
/// that the grain displaces: F = C rho V (Du/Dt - dv/dt). `share(void_fraction)` is C [1].

/// Single sphere: 1/2, exact in potential flow and, measured as the force right after a change of
/// speed, at any Reynolds number.
struct SphereAddedMass {
  static constexpr const char* kName = "sphere";
  static constexpr const char* kSource = "Green 1833; Auton, Hunt, Prud'homme 1988";
  static double share(double /*void_fraction*/) { return 0.5; }
};

/// Spheres among spheres: 1/2 (1 + 2 s)/(1 - s), s the solid fraction.
struct ZuberAddedMass {
  static constexpr const char* kName = "zuber";
  static constexpr const char* kSource = "Zuber 1964, Chem. Eng. Sci. 19, 897";
  static double share(double void_fraction) {
    return 0.5 * (3.0 - 2.0 * void_fraction) / void_fraction;
  }
};

}  // namespace grouser
