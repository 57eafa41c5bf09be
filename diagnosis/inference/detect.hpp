// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "diagnosis/inference/fit.hpp"

namespace grouser::diagnosis {

/// A stretch of one channel whose residual stands out.
struct ScanCell {
  std::size_t condition = 0;
  std::size_t channel = 0;
  std::size_t from = 0;  ///< first sample
  std::size_t to = 0;    ///< one behind the last
  double z = 0.0;        ///< sum of the whitened residual over the root of its length
};

/// Whether a fitted model differs from the recording by more than noise and parameters allow.
struct Detection {
  double p_global = 1.0;        ///< likelihood and priors together
  double p_scan = 1.0;          ///< largest |z| over all channels, conditions and windows
  double p_stress = 1.0;        ///< parameters pushed from their priors alone
  double p = 1.0;               ///< family-wise: three times the least, at most 1
  double threshold = 0.0;       ///< |z| that the scan passes once in a hundred
  std::vector<double> draws;    ///< the largest |z| of every draw of the null
  std::vector<ScanCell> cells;  ///< all windows, the largest |z| first

  bool is_mismatch(double level) const { return p < level; }
};

/// Chances under the model itself: `draws` draws of noise and parameters from their priors go
/// through the same linear projection as the fit, each with noise whose spread and correlation
/// differ from the estimate by what the estimate may be off, so that correlation between the
/// windows and the parameters' appetite for misfits are counted. Holds as far as the model is
/// linear in its parameters over their posterior. Windows are 1/16, 1/8, 1/4 and 1/2 of a series,
/// overlapping by half. Local.
Detection detect(const Study& study, const Fit& fit, int draws, unsigned seed);

}  // namespace grouser::diagnosis
