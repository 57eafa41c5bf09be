// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Single sphere with a boundary layer of thickness 9.06/sqrt(Re): Cd = 24/9.06^2 (1
/// + 9.06/sqrt(Re))^2. The law behind the terminal speeds of ten Cate et al. 2002.
struct AbrahamDrag {
  static constexpr const char* kName = "abraham";
  static constexpr const char* kSource = "Abraham 1970, Phys. Fluids 13, 2194";
  static constexpr bool kUsesVoidFraction = false;
  static constexpr std::array kBands{DragBand{0.0, 6000.0, 0.12}};

  static double factor(double reynolds, double /*void_fraction*/) {
    const double layer = 1.0 + std::sqrt(reynolds) / 9.06;
    return layer * layer;
  }
};

}  // namespace grouser
