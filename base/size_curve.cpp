// SPDX-License-Identifier: BSD-3-Clause
#include "base/size_curve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grouser {
namespace {

// Integral of d^n over [a, b] divided by (b - a).
double mean_power(double a, double b, int n) {
  return (std::pow(b, n + 1) - std::pow(a, n + 1)) / ((n + 1) * (b - a));
}

}  // namespace

SizeCurve::SizeCurve(const GrainsCase& grains) {
  for (const SizePoint& point : grains.size_curve) {
    diameter_.push_back(point.diameter * grains.coarse_graining);
    finer_.push_back(point.finer);
  }
  if (grains.size_basis == "number") return;
  // Grains are drawn with even numbers over a piece; then its mass is number times mean d^3.
  std::vector<double> numbers{0.0};
  for (std::size_t i = 1; i < diameter_.size(); ++i) {
    const double per_number = mean_power(diameter_[i - 1], diameter_[i], 3);
    numbers.push_back(numbers.back() + (finer_[i] - finer_[i - 1]) / per_number);
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) finer_[i] = numbers[i] / numbers.back();
}

double SizeCurve::diameter_at(double unit) const {
  const auto above = std::upper_bound(finer_.begin(), finer_.end(), unit);
  if (above == finer_.begin()) return diameter_.front();
  if (above == finer_.end()) return diameter_.back();
  const auto i = static_cast<std::size_t>(above - finer_.begin());
  const double part = (unit - finer_[i - 1]) / (finer_[i] - finer_[i - 1]);
  return diameter_[i - 1] + part * (diameter_[i] - diameter_[i - 1]);
}

double SizeCurve::mean() const {
  double sum = 0.0;
  for (std::size_t i = 1; i < diameter_.size(); ++i)
    sum += (finer_[i] - finer_[i - 1]) * mean_power(diameter_[i - 1], diameter_[i], 1);
  return sum;
}

double SizeCurve::mean_volume() const {
  double sum = 0.0;
  for (std::size_t i = 1; i < diameter_.size(); ++i)
    sum += (finer_[i] - finer_[i - 1]) * mean_power(diameter_[i - 1], diameter_[i], 3);
  return sum * std::numbers::pi / 6.0;
}

double grain_count(const Case& input) {
  return input.bed.solid_fraction * input.box.length * input.box.width * input.bed.depth /
         SizeCurve(input.grains).mean_volume();
}

}  // namespace grouser
