// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Fixed random arrays of spheres from lattice-Boltzmann runs: n^2 (F0 + F3 Re_a), Re_a = n Re / 2
/// the Reynolds number of flux and radius. F0 is the creeping limit, F3 the inertial slope.
/// Neglected: the regime of Re_a^2 below Re_a of about 1, where F3 Re_a overestimates inertia by
/// up to 10 % of the drag of a dilute array; it is a law for n below 0.9.
struct KochHillDrag {
  static constexpr const char* kName = "koch_hill";
  static constexpr const char* kSource = "Koch and Hill 2001; Hill, Koch, Ladd 2001";
  static constexpr bool kUsesVoidFraction = true;
  static constexpr std::array kBands{DragBand{0.0, 80.0, 0.2}};

  static double creeping(double solid) {
    if (solid >= 0.4) return 10.0 * solid / std::pow(1.0 - solid, 3);
    const double logarithm = solid > 0.0 ? solid * std::log(solid) : 0.0;
    return (1.0 + 3.0 * std::sqrt(0.5 * solid) + 135.0 / 64.0 * logarithm + 16.14 * solid) /
           (1.0 + 0.681 * solid - 8.48 * solid * solid + 8.16 * solid * solid * solid);
  }
  static double inertial(double solid) {
    return 0.0673 + 0.212 * solid + 0.0232 / std::pow(1.0 - solid, 5);
  }

  static double factor(double reynolds, double void_fraction) {
    const double solid = 1.0 - void_fraction;
    return void_fraction * void_fraction *
           (creeping(solid) + 0.5 * inertial(solid) * void_fraction * reynolds);
  }
};

}  // namespace grouser
