// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "campaign/report/observables.hpp"

namespace grouser {

/// Mean of a correlated series with its standard error.
struct Estimate {
  double mean = kNaN;
  double error = kNaN;        ///< standard error of the mean; NaN when it cannot be known
  double drift = kNaN;        ///< change over the series by a straight line; NaN when not known
  double drift_error = kNaN;  ///< standard error of the drift
  std::size_t count = 0;      ///< values used

  /// Whether the series rises or falls beyond chance (three standard errors) by more than a tenth
  /// of its mean: it is then not steady and its mean depends on the window.
  bool is_drifting() const;
};

/// Mean and its standard error by batch means: the series is cut into equal consecutive batches,
/// whose means are nearly independent when a batch is much longer than the correlation time. Holds
/// for a stationary series; a trend makes the error too large, correlation over more than a
/// batch makes it too small. The drift is the least-squares line through the batch means. NaN
/// values are left out. Local.
/// @param batches wanted; fewer when a batch would have less than two values
/// Source: Law and Kelton, Simulation Modeling and Analysis, section 9.5.3.
Estimate batch_means(const std::vector<double>& values, std::size_t batches = 10);

/// Values of equal standing (one per seed) in numbers.
struct Scatter {
  double mean = kNaN;
  double deviation = kNaN;  ///< standard deviation with n - 1; NaN for one value
  double low = kNaN;
  double high = kNaN;
  std::size_t count = 0;
};

/// NaN values are left out. Local.
Scatter scatter_of(const std::vector<double>& values);

/// Value below which the fraction `quantile` of the finite values lies, NaN if there is none.
double quantile_of(std::vector<double> values, double quantile);

}  // namespace grouser
