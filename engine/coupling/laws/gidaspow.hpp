// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "engine/coupling/laws/drag.hpp"
#include "engine/coupling/laws/schiller_naumann.hpp"

namespace grouser {

/// Packed bed: pressure drop 150 mu U (1 - n)^2/(n^3 d^2) + 1.75 rho U^2 (1 - n)/(n^3 d) at flux U.
/// Not for dilute suspensions: the viscous part goes to zero with the solid fraction.
struct ErgunDrag {
  static double factor(double reynolds, double void_fraction) {
    return (150.0 * (1.0 - void_fraction) / void_fraction + 1.75 * reynolds) / 18.0;
  }
};

/// Suspension: the single sphere's drag at the flux times n^-4.65 in the balance of forces, which
/// is n^-2.65 on the drag without pressure gradient.
struct WenYuDrag {
  static constexpr const char* kName = "wen_yu";
  static constexpr const char* kSource = "Wen and Yu 1966; Schiller and Naumann 1933";
  static constexpr bool kUsesVoidFraction = true;
  static constexpr std::array kBands = SchillerNaumannDrag::kBands;

  static double factor(double reynolds, double void_fraction) {
    return SchillerNaumannDrag::factor(void_fraction * reynolds, 1.0) *
           std::pow(void_fraction, -2.65);
  }
};

/// Ergun below a void fraction of 0.8, Wen and Yu above; the drag steps there.
struct GidaspowDrag {
  static constexpr const char* kName = "gidaspow";
  static constexpr const char* kSource = "Gidaspow 1994; Ergun 1952; Wen and Yu 1966";
  static constexpr bool kUsesVoidFraction = true;
  static constexpr std::array kBands = SchillerNaumannDrag::kBands;

  static double factor(double reynolds, double void_fraction) {
    return void_fraction < 0.8 ? ErgunDrag::factor(reynolds, void_fraction)
                               : WenYuDrag::factor(reynolds, void_fraction);
  }
};

}  // namespace grouser
