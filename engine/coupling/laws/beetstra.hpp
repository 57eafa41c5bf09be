// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Arrays of spheres from lattice-Boltzmann runs, for solid fractions up to 0.6 and Reynolds
/// numbers of the flux up to 1000: n F, with F over Stokes' drag at the flux.
struct BeetstraDrag {
  static constexpr const char* kName = "beetstra";
  static constexpr const char* kSource = "Beetstra, van der Hoef, Kuipers 2007";
  static constexpr bool kUsesVoidFraction = true;
  static constexpr std::array kBands{DragBand{0.0, 100.0, 0.17}};

  static double factor(double reynolds, double void_fraction) {
    const double n = void_fraction;
    const double solid = 1.0 - n;
    const double creeping = 10.0 * solid / (n * n) + n * n * (1.0 + 1.5 * std::sqrt(solid));
    // Its inertial part goes to zero with the Reynolds number, through 0 times infinity.
    const double flux = std::max(n * reynolds, 1e-12);
    const double inertial =
        0.413 * flux / (24.0 * n * n) * (1.0 / n + 3.0 * n * solid + 8.4 * std::pow(flux, -0.343)) /
        (1.0 + std::pow(10.0, 3.0 * solid) * std::pow(flux, -0.5 * (1.0 + 4.0 * solid)));
    return n * (creeping + inertial);
  }
};

}  // namespace grouser
