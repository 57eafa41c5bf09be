// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/coupling/laws/brown_lawler.hpp"
#include "engine/coupling/laws/dallavalle.hpp"
#include "engine/coupling/laws/drag.hpp"

namespace grouser {

/// Voidage function of Di Felice on the drag of a single sphere at the same flux n |u - v|, n the
/// void fraction: F = F_single(n |u - v|) n^-chi, chi = 3.7 - 0.65 exp(-(1.5 - log10 Re_n)^2 / 2),
/// Re_n = n Re. Below Re_n = 1e-3, where chi is 3.7 to five digits, its logarithm is cut.
template <class Single>
struct DiFeliceOn {
  static constexpr bool kUsesVoidFraction = true;
  static constexpr std::array kBands = Single::kBands;

  static double factor(double reynolds, double void_fraction) {
    const double flux = void_fraction * reynolds;
    const double distance = 1.5 - std::log10(std::max(flux, 1e-3));
    const double exponent = 3.7 - 0.65 * std::exp(-0.5 * distance * distance);
    return Single::factor(flux, 1.0) * std::pow(void_fraction, 1.0 - exponent);
  }
};

/// With the single-sphere law of the original.
struct DiFeliceDrag : DiFeliceOn<DallaValleDrag> {
  static constexpr const char* kName = "di_felice";
  static constexpr const char* kSource = "Di Felice 1994; DallaValle 1948";
};

/// With a single-sphere law that has the right creeping limit.
struct DiFeliceBrownLawlerDrag : DiFeliceOn<BrownLawlerDrag> {
  static constexpr const char* kName = "di_felice_brown_lawler";
  static constexpr const char* kSource = "Di Felice 1994; Brown and Lawler 2003";
};

}  // namespace grouser
