// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/recordings/noise.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace grouser::diagnosis {
namespace {

constexpr double kLowestFrequency = 1.0 / 16.0;  // of the sampling frequency

/// Periodogram of `values` without their mean at the frequencies k/n, k = 0..n/2.
std::vector<double> periodogram(const std::vector<double>& values) {
  const std::size_t n = values.size();
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(n);
  std::vector<double> in(n);
  // A Hann taper keeps slow misfits from leaking upward; it is scaled to keep noise's power.
  for (std::size_t i = 0; i < n; ++i)
    in[i] = (values[i] - mean) * std::sqrt(2.0 / 3.0) *
            (1.0 - std::cos(2.0 * std::numbers::pi * (double(i) + 0.5) / double(n)));
  std::vector<std::complex<double>> out(n / 2 + 1);
  fftw_plan plan = fftw_plan_dft_r2c_1d(static_cast<int>(n), in.data(),
                                        reinterpret_cast<fftw_complex*>(out.data()), FFTW_ESTIMATE);
  fftw_execute(plan);
  fftw_destroy_plan(plan);
  std::vector<double> power(out.size());
  std::transform(out.begin(), out.end(), power.begin(),
                 [&](const std::complex<double>& z) { return std::norm(z) / double(n); });
  return power;
}

double shape_at(std::size_t k, std::size_t n, double correlation) {
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
  return 1.0 / (1.0 - 2.0 * correlation * std::cos(angle) + correlation * correlation);
}

/// -2 ln of Whittle's likelihood, the step variance profiled out and returned in `variance`.
double misfit(const std::vector<double>& power, std::size_t from, std::size_t n, double correlation,
              double& variance) {
  double sum = 0.0;
  double logs = 0.0;
  const auto count = static_cast<double>(power.size() - from);
  for (std::size_t k = from; k < power.size(); ++k) {
    const double shape = shape_at(k, n, correlation);
    sum += power[k] / shape;
    logs += std::log(shape);
  }
  variance = sum / count;
  return 2.0 * (count * std::log(std::max(variance, 1e-300)) + logs);
}

/// Searches the correlation. @return its misfit
double best_correlation(const std::vector<double>& power, std::size_t from, std::size_t n,
                        double& correlation, double& variance) {
  constexpr double kStep = 0.01;
  constexpr double kLimit = 0.95;
  double best = INFINITY;
  for (double rho = -0.5; rho <= kLimit; rho += kStep) {
    double at = 0.0;
    const double value = misfit(power, from, n, rho, at);
    if (value >= best) continue;
    best = value;
    correlation = rho;
    variance = at;
  }
  return best;
}

/// Cuts ordinates that noise of that model would pass once in a thousand recordings (they are
/// exponential). @return whether there were any
bool cut_lines(std::vector<double>& power, std::size_t from, std::size_t n, double correlation,
               double variance) {
  const double limit = std::log(1000.0 * static_cast<double>(power.size() - from));
  bool is_cut = false;
  for (std::size_t k = from; k < power.size(); ++k) {
    const double noise = variance * shape_at(k, n, correlation);
    if (power[k] <= limit * noise) continue;
    power[k] = noise;
    is_cut = true;
  }
  return is_cut;
}

}  // namespace

double NoiseModel::step_sd() const { return sd * std::sqrt(1.0 - correlation * correlation); }

NoiseModel fit_noise(const std::vector<double>& residual) {
  NoiseModel noise;
  const std::size_t n = residual.size();
  std::vector<double> power = periodogram(residual);
  const auto from = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(kLowestFrequency * static_cast<double>(n))));
  double variance = 0.0;
  double best = best_correlation(power, from, n, noise.correlation, variance);
  // A swing is a line in the periodogram, not noise: lines are cut to where noise could be.
  for (int pass = 0; pass < 3; ++pass) {
    if (!cut_lines(power, from, n, noise.correlation, variance)) break;
    best = best_correlation(power, from, n, noise.correlation, variance);
  }
  noise.sd = std::sqrt(variance / (1.0 - noise.correlation * noise.correlation));
  const auto ordinates = static_cast<double>(power.size() - from);
  noise.freedom = 1.0 * ordinates;  // 2 without a taper; Hann correlates neighbours
  // Curvature of the profile, over a distance at which the step of the search does not matter.
  double unused = 0.0;
  const double side = 0.1;
  const double low = misfit(power, from, n, std::max(-0.9, noise.correlation - side), unused);
  const double high = misfit(power, from, n, std::min(0.99, noise.correlation + side), unused);
  const double curvature = (low + high - 2.0 * best) / (2.0 * side * side);
  noise.correlation_error = curvature > 0.0 ? std::min(0.5, 1.0 / std::sqrt(curvature)) : 0.5;
  return noise;
}

double rough_noise_sd(const std::vector<double>& values) {
  if (values.size() < 8) return 0.0;
  std::vector<double> sizes;
  for (std::size_t i = 3; i < values.size(); ++i)
    sizes.push_back(
        std::abs(values[i] - 3.0 * values[i - 1] + 3.0 * values[i - 2] - values[i - 3]));
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  // Third differences of white noise have variance 20; the median of |N(0,1)| is 0.6745.
  return *middle / 0.6745 / std::sqrt(20.0);
}

void whiten(const NoiseModel& noise, double* values, std::size_t count) {
  if (count == 0) return;
  const double step = 1.0 / noise.step_sd();
  double before = values[0];
  values[0] /= noise.sd;
  for (std::size_t i = 1; i < count; ++i) {
    const double now = values[i];
    values[i] = (now - noise.correlation * before) * step;
    before = now;
  }
}

}  // namespace grouser::diagnosis
