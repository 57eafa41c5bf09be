// SPDX-License-Identifier: BSD-3-Clause
#include "engine/coupling/history_modes.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace grouser {
namespace {

// Rates from here down, each e times slower than the one before: what they leave out of half a step
// is exp(-12).
constexpr double kFastest = 24.0;
const double kPlain = 1.0 / std::sqrt(std::numbers::pi);

// Density of the kernel's rates over ln(rate), for T = 1, times rate^(-1/2): 1/sqrt(pi) for fast
// rates, going to zero with slow ones.
class Spectrum {
 public:
  Spectrum() {
    for (double at = kLow; at <= kHigh + 0.5 * kStep; at += kStep)
      values_.push_back(density(std::exp(at)));
  }

  double at(double rate) const {
    const double place = (std::log(rate) - kLow) / kStep;
    if (!(place > 0.0)) return 0.0;
    if (place >= static_cast<double>(values_.size() - 1)) return kPlain;
    const auto i = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(i);
    return (1.0 - part) * values_[i] + part * values_[i + 1];
  }

 private:
  static constexpr double kLow = -25.0;
  static constexpr double kHigh = 20.0;
  static constexpr double kStep = 0.05;

  // Laplace transform of the kernel's jump across the negative times,
  // r^(-1/2) (1 - sqrt2 q)/(1 - sqrt2 q + q^2)^2 with q = r^(3/4), over pi.
  static double density(double rate) {
    double sum = 0.0;
    for (double s = -70.0; s <= 40.0; s += kStep) {
      const double r = std::exp(s);
      const double q = std::exp(0.75 * s);
      const double square = 1.0 - std::numbers::sqrt2 * q + q * q;
      sum += std::exp(0.5 * s - rate * r) * (1.0 - std::numbers::sqrt2 * q) / (square * square);
    }
    return std::sqrt(rate) * sum * kStep / std::numbers::pi;
  }

  std::vector<double> values_;
};

}  // namespace

HistoryModes::HistoryModes(double time_step)
    : time_step_(time_step), local_(2.0 * std::sqrt(0.5 * time_step)) {
  for (std::size_t k = 0; k + 1 < kModes; ++k) {
    const double scaled = kFastest * std::exp(-static_cast<double>(k));
    rate_[k] = scaled / time_step;
    half_[k] = std::exp(-0.5 * scaled);
    step_[k] = std::exp(-scaled);
    gain_[k] = -std::expm1(-scaled) / rate_[k];
  }
  half_.back() = step_.back() = 1.0;
  gain_.back() = time_step;
}

HistoryModes::Weights HistoryModes::weights(double memory_time) const {
  static const Spectrum spectrum;
  const bool is_endless = std::isinf(memory_time);
  const auto density = [&](double rate) {
    return std::sqrt(rate) * (is_endless ? kPlain : spectrum.at(rate * memory_time));
  };
  Weights weights{};
  for (std::size_t k = 0; k + 1 < kModes; ++k) weights[k] = density(rate_[k]);
  // All slower rates together; they fall by e each, so 16 are enough for one part in 3000.
  weights.back() = 0.0;
  for (int k = 1; k <= 16; ++k)
    weights.back() += density(rate_[kModes - 2] * std::exp(-static_cast<double>(k)));
  return weights;
}

double HistoryModes::kernel(const Weights& weights, double time) const {
  double sum = weights.back();
  for (std::size_t k = 0; k + 1 < kModes; ++k) sum += weights[k] * std::exp(-rate_[k] * time);
  return sum;
}

Vec3 HistoryModes::past(const Weights& weights, const Memory& memory) const {
  Vec3 sum;
  for (std::size_t k = 0; k < kModes; ++k) sum += (weights[k] * half_[k]) * memory[k];
  return sum;
}

void HistoryModes::remember(const Vec3& acceleration, Memory& memory) const {
  for (std::size_t k = 0; k < kModes; ++k)
    memory[k] = step_[k] * memory[k] + gain_[k] * acceleration;
}

}  // namespace grouser
