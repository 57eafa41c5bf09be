// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Creeping flow: the drag is 3 pi mu d (u - v) at any speed. Inertia of the fluid is neglected.
struct StokesDrag {
  static constexpr const char* kName = "stokes";
  static constexpr const char* kSource = "Stokes 1851";
  static constexpr bool kUsesVoidFraction = false;
  // The first neglected term is 3/16 Re (Oseen).
  static constexpr std::array kBands{DragBand{0.0, 0.1, 0.02}};

  static double factor(double /*reynolds*/, double /*void_fraction*/) { return 1.0; }
};

}  // namespace grouser
