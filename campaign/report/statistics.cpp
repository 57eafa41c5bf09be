// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace grouser {
namespace {

std::vector<double> finite_of(const std::vector<double>& values) {
  std::vector<double> finite;
  finite.reserve(values.size());
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double value) { return std::isfinite(value); });
  return finite;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values, double mean) {
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

/// Straight line through the batch means: `drift` over the whole series and its standard error.
void add_drift(const std::vector<double>& means, Estimate& estimate) {
  const auto number = static_cast<double>(means.size());
  if (means.size() < 4) return;  // too few to tell a line from scatter
  const double middle = 0.5 * (number - 1.0);
  const double mean = mean_of(means);
  double spread = 0.0;
  double slope = 0.0;
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double at = static_cast<double>(i) - middle;
    spread += at * at;
    slope += at * (means[i] - mean);
  }
  slope /= spread;
  double squares = 0.0;
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double rest = means[i] - mean - slope * (static_cast<double>(i) - middle);
    squares += rest * rest;
  }
  estimate.drift = slope * number;
  estimate.drift_error = number * std::sqrt(squares / (number - 2.0) / spread);
}

}  // namespace

bool Estimate::is_drifting() const {
  return std::abs(drift) > 3.0 * drift_error && std::abs(drift) > 0.1 * std::abs(mean);
}

Estimate batch_means(const std::vector<double>& values, std::size_t batches) {
  const std::vector<double> finite = finite_of(values);
  Estimate estimate;
  estimate.count = finite.size();
  if (finite.empty()) return estimate;
  estimate.mean = mean_of(finite);
  const std::size_t number = std::min(batches, finite.size() / 2);
  if (number < 2) return estimate;
  const std::size_t length = finite.size() / number;
  std::vector<double> means;
  // The remainder is left out at the start, the part nearest to the transient.
  auto from = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() - number * length);
  for (std::size_t batch = 0; batch < number; ++batch) {
    const auto to = from + static_cast<std::ptrdiff_t>(length);
    means.push_back(std::accumulate(from, to, 0.0) / static_cast<double>(length));
    from = to;
  }
  estimate.error = deviation_of(means, mean_of(means)) / std::sqrt(static_cast<double>(number));
  add_drift(means, estimate);
  return estimate;
}

Scatter scatter_of(const std::vector<double>& values) {
  const std::vector<double> finite = finite_of(values);
  Scatter scatter;
  scatter.count = finite.size();
  if (finite.empty()) return scatter;
  scatter.mean = mean_of(finite);
  const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
  scatter.low = *low;
  scatter.high = *high;
  if (finite.size() > 1) scatter.deviation = deviation_of(finite, scatter.mean);
  return scatter;
}

double quantile_of(std::vector<double> values, double quantile) {
  values = finite_of(values);
  if (values.empty()) return kNaN;
  const auto rank = static_cast<std::ptrdiff_t>(std::clamp(quantile, 0.0, 1.0) *
                                                static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace grouser
