// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// What every drag law of the table says of itself and can do.
///
/// `factor(reynolds, void_fraction)` is the drag over Stokes' 3 pi mu d |u - v|, where u is the
/// fluid's velocity in the pores and v the grain's: F = factor 3 pi mu d (u - v). Reynolds number:
/// rho d |u - v| / mu, without the void fraction. The force leaves out the pressure gradient
/// (model A): a grain in a bed feels it besides, as -V grad p.
///
/// A band is a range of Reynolds numbers in which the law follows the standard drag curve of a
/// single sphere (Clift, Grace, Weber 1978, table 5.2) to `tolerance`, as a share of the drag. A
/// law without a band above some Reynolds number is not meant for it.
struct DragBand {
  double low = 0.0;   ///< Reynolds number [1]
  double high = 0.0;  ///< [1]
  double tolerance = 0.0;
};

/// A drag coefficient Cd turned into a factor: Cd Re / 24.
inline double factor_of_coefficient(double coefficient, double reynolds) {
  return coefficient * reynolds / 24.0;
}

}  // namespace grouser
