// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace grouser::diagnosis {

/// Noise of one series: first-order autoregressive from sample to sample,
/// e[i] = correlation * e[i-1] + w[i] with independent normal w.
struct NoiseModel {
  double sd = 0.0;                 ///< of e itself [unit of the series]
  double correlation = 0.0;        ///< from one sample to the next, below 1
  double correlation_error = 0.0;  ///< standard error
  double freedom = 1.0;            ///< degrees of freedom of the estimate of sd

  /// Standard deviation of w.
  double step_sd() const;
};

/// Noise of a residual whose slow part may be a misfit: fitted to the periodogram above 1/16 of the
/// sampling frequency alone, where curves of bodies under forces have little left. A misfit with
/// jumps between samples makes it too large. Needs 16 values.
/// Neighbouring ordinates of the tapered periodogram are not quite independent, which is counted in
/// the degrees of freedom. Source: Whittle 1953 (likelihood of a periodogram). Local.
NoiseModel fit_noise(const std::vector<double>& residual);

/// Standard deviation of white noise on a smooth curve, from third differences by their median, so
/// that a few jumps do not matter. 0 for fewer than 8 values. Local.
double rough_noise_sd(const std::vector<double>& values);

/// Makes noise of that model independent with unit variance, in place; the first value by its
/// stationary spread. Linear, so columns of derivatives may go through it as well. Local.
void whiten(const NoiseModel& noise, double* values, std::size_t count);

}  // namespace grouser::diagnosis
