// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/plan/planner.hpp"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr double kAssumedMtbf = 86400.0;
constexpr double kQuarterHour = 900.0;
constexpr double kReserve = 1.5;
// Start of the ranks, reading of the checkpoint, last words.
constexpr double kAround = 120.0;

}  // namespace

double young_interval(double cost, double mtbf) { return std::sqrt(2.0 * cost * mtbf); }

double daly_interval(double cost, double mtbf) {
  if (cost >= 2.0 * mtbf) return mtbf;
  const double share = cost / (2.0 * mtbf);
  return young_interval(cost, mtbf) * (1.0 + std::sqrt(share) / 3.0 + share / 9.0) - cost;
}

double expected_wall_time(double work, double interval, double cost, double restart, double mtbf) {
  return mtbf * std::exp(restart / mtbf) * std::expm1((interval + cost) / mtbf) * work / interval;
}

double mtbf_after(double observed, int failures) {
  return (observed + kAssumedMtbf) / (failures + 1);
}

double percentile95(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(values.size())));
  return values[rank - 1];
}

double checkpoint_seconds(const Measured& measured) {
  const double cost = percentile95(measured.checkpoint_costs);
  if (cost <= 0.0) return 0.0;
  return daly_interval(cost, mtbf_after(measured.observed, measured.failures));
}

double job_walltime(double left, double longest, const Measured& measured) {
  if (left <= 0.0) return longest;
  const double needed = kReserve * left + kAround + 2.0 * percentile95(measured.checkpoint_costs);
  return std::min(longest, std::ceil(needed / kQuarterHour) * kQuarterHour);
}

}  // namespace grouser
