// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/case.hpp"

namespace grouser {

/// Draws grain diameters from a size curve.
class SizeCurve {
 public:
  /// Between two points of the curve diameters are spread evenly by number. A curve by mass is
  /// turned into one by number so that each piece holds its mass. Diameters include coarse
  /// graining.
  explicit SizeCurve(const GrainsCase& grains);

  /// Diameter [m] below which a fraction `unit` (0 to 1) of all grains is.
  double diameter_at(double unit) const;
  double smallest() const { return diameter_.front(); }
  double largest() const { return diameter_.back(); }
  double mean() const;         ///< by number [m]
  double mean_volume() const;  ///< of a grain [m3]

 private:
  std::vector<double> diameter_;
  std::vector<double> finer_;  // by number
};

/// Grains that the bed of a case is expected to take [1]; infinite or NaN for a broken curve.
double grain_count(const Case& input);

}  // namespace grouser
