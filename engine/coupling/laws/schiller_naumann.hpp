// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Single sphere: Cd = 24/Re (1 + 0.15 Re^0.687), and Newton's 0.44 beyond Re = 1000, where the
/// formula has come to 0.438; it steps up there by 0.4 %.
struct SchillerNaumannDrag {
  static constexpr const char* kName = "schiller_naumann";
  static constexpr const char* kSource =
      "Schiller and Naumann 1933; Clift, Grace, Weber 1978, table 5.1 (+5 to -4 % below Re 800)";
  static constexpr bool kUsesVoidFraction = false;
  static constexpr std::array kBands{DragBand{0.0, 800.0, 0.055}, DragBand{800.0, 1e5, 0.16}};

  static double factor(double reynolds, double /*void_fraction*/) {
    if (reynolds > 1000.0) return factor_of_coefficient(0.44, reynolds);
    return 1.0 + 0.15 * std::pow(reynolds, 0.687);
  }
};

}  // namespace grouser
