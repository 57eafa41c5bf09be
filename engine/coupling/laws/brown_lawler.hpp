// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Single sphere: Cd = 24/Re (1 + 0.15 Re^0.681) + 0.407/(1 + 8710/Re), fitted to 480 measured
/// points corrected for walls.
struct BrownLawlerDrag {
  static constexpr const char* kName = "brown_lawler";
  static constexpr const char* kSource = "Brown and Lawler 2003";
  static constexpr bool kUsesVoidFraction = false;
  static constexpr std::array kBands{DragBand{0.0, 1e5, 0.08}};

  static double factor(double reynolds, double /*void_fraction*/) {
    // 0.407/(1 + 8710/Re) Re/24, written so that Re = 0 divides by nothing.
    return 1.0 + 0.15 * std::pow(reynolds, 0.681) +
           0.407 / 24.0 * reynolds * (reynolds / (reynolds + 8710.0));
  }
};

}  // namespace grouser
