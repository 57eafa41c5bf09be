// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Single sphere: Cd = (0.63 + 4.8/sqrt(Re))^2. Its creeping limit is 4 % below Stokes.
struct DallaValleDrag {
  static constexpr const char* kName = "dallavalle";
  static constexpr const char* kSource = "DallaValle 1948";
  static constexpr bool kUsesVoidFraction = false;
  static constexpr std::array kBands{DragBand{0.0, 100.0, 0.14}, DragBand{100.0, 1e5, 0.31}};

  static double factor(double reynolds, double /*void_fraction*/) {
    const double root = 0.63 * std::sqrt(reynolds) + 4.8;
    return root * root / 24.0;
  }
};

}  // namespace grouser
