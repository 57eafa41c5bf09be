// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/recordings/admission.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "base/units.hpp"
#include "diagnosis/recordings/noise.hpp"

namespace grouser::diagnosis {
namespace {

constexpr double kFaultAt = 4.0;  // standard errors: one in 16 000 by chance

double median_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Regular sampling with holes; irregular sampling (digitised curves) has none.
void find_missing_rows(const Condition& condition, std::vector<Finding>& findings) {
  const double step = median_step(condition.times);
  std::size_t regular = 0;
  for (std::size_t i = 1; i < condition.times.size(); ++i)
    regular += std::abs(condition.times[i] - condition.times[i - 1] - step) < 0.1 * step ? 1 : 0;
  if (10 * regular < 9 * (condition.times.size() - 1)) return;
  for (std::size_t i = 1; i < condition.times.size(); ++i) {
    const double missing = std::round((condition.times[i] - condition.times[i - 1]) / step) - 1.0;
    if (missing < 1.0) continue;
    findings.push_back({condition.name, "", "missing_rows", condition.lines[i],
                        format_number(missing) + " rows are missing before this line; nothing is "
                                                 "put in their place",
                        false});
  }
}

/// A run of equal values at the end of a range whose other values scatter.
void find_clipping(const SeriesRecording& recording, const Condition& condition, std::size_t c,
                   std::vector<Finding>& findings) {
  const std::vector<double>& values = condition.samples[c];
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  for (const double end : {*low, *high}) {
    std::vector<double> others;
    std::copy_if(values.begin(), values.end(), std::back_inserter(others),
                 [&](double value) { return value != end; });
    const std::size_t equal = values.size() - others.size();
    const double noise = rough_noise_sd(others);
    if (equal < std::max<std::size_t>(5, values.size() / 50) || noise == 0.0) continue;
    const auto first = std::find(values.begin(), values.end(), end);
    findings.push_back({condition.name, recording.channels[c].name, "clipping",
                        condition.lines[static_cast<std::size_t>(first - values.begin())],
                        std::to_string(equal) + " samples have exactly the " +
                            (end == *low ? "lowest" : "highest") + " value, " + format_number(end) +
                            " " + entry_of(recording.channels[c].signal).unit +
                            ", while the others scatter by " + rounded(noise) +
                            ": the sensor's range ends there",
                        true});
  }
}

std::optional<std::size_t> channel_of(const SeriesRecording& recording, Signal signal) {
  for (std::size_t c = 0; c < recording.channels.size(); ++c)
    if (recording.channels[c].signal == signal) return c;
  return std::nullopt;
}

void compare_channels(const SeriesRecording& recording, const Condition& condition,
                      std::vector<Finding>& findings) {
  const std::optional<std::size_t> gap = channel_of(recording, Signal::kGap);
  std::optional<std::size_t> speed = channel_of(recording, Signal::kSettlingSpeed);
  const double sign = speed ? 1.0 : -1.0;
  if (!speed) speed = channel_of(recording, Signal::kVerticalVelocity);
  if (!gap || !speed) return;
  std::vector<double> downward = condition.samples[*speed];
  for (double& value : downward) value *= sign;
  const double stated = recording.channels[*gap].noise_sd;
  const double noise = stated > 0.0 ? stated : rough_noise_sd(condition.samples[*gap]);
  const Consistency c =
      compare_gap_and_speed(condition.times, condition.samples[*gap], downward, noise);
  const std::string& name = recording.channels[*speed].name;
  if (std::abs(c.gain - 1.0) > kFaultAt * c.gain_error && std::abs(c.gain - 1.0) > 0.005)
    findings.push_back({condition.name, name, "gain", 0,
                        "the gap changes by " + rounded(c.gain) + " +- " + rounded(c.gain_error) +
                            " times the integral of the speed: one of the two scales is wrong",
                        true});
  if (std::abs(c.lag) > kFaultAt * c.lag_error && std::abs(c.lag) > median_step(condition.times))
    findings.push_back({condition.name, name, "lag", 0,
                        "the speed is " + rounded(1e3 * c.lag) + " +- " +
                            rounded(1e3 * c.lag_error) + " ms behind the gap",
                        true});
}

}  // namespace

Consistency compare_gap_and_speed(const std::vector<double>& times, const std::vector<double>& gap,
                                  const std::vector<double>& speed, double gap_noise_sd) {
  // gap = start - gain * integral(speed) - gain * lag * (speed - its first value), first order in
  // the lag.
  const auto n = static_cast<Eigen::Index>(times.size());
  Eigen::MatrixXd columns(n, 3);
  Eigen::VectorXd values(n);
  double integral = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (at > 0) integral += 0.5 * (speed[at] + speed[at - 1]) * (times[at] - times[at - 1]);
    columns.row(i) << 1.0, -integral, -speed[at];
    values(i) = gap[at];
  }
  const Eigen::Matrix3d normal = columns.transpose() * columns;
  const Eigen::Matrix3d inverse = normal.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::Vector3d fit = inverse * (columns.transpose() * values);
  const double scatter =
      std::max(gap_noise_sd, (values - columns * fit).norm() / std::sqrt(static_cast<double>(n)));
  Consistency c;
  c.gain = fit(1);
  c.gain_error = scatter * std::sqrt(std::max(0.0, inverse(1, 1)));
  c.lag = fit(2) / fit(1);
  c.lag_error = scatter * std::sqrt(std::max(0.0, inverse(2, 2))) / std::abs(fit(1));
  return c;
}

std::vector<Finding> admit(const SeriesRecording& recording) {
  std::vector<Finding> findings;
  for (const Condition& condition : recording.conditions) {
    if (condition.times.size() < 2) continue;
    find_missing_rows(condition, findings);
    for (std::size_t c = 0; c < recording.channels.size(); ++c)
      find_clipping(recording, condition, c, findings);
    compare_channels(recording, condition, findings);
  }
  return findings;
}

}  // namespace grouser::diagnosis
