// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/recordings/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace grouser::diagnosis {
namespace {

std::vector<double> noise_of(std::size_t count, double sd, double correlation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values{sd * normal(random)};
  while (values.size() < count)
    values.push_back(correlation * values.back() +
                     sd * std::sqrt(1.0 - correlation * correlation) * normal(random));
  return values;
}

TEST(Noise, SpreadAndCorrelationAreFoundUnderASlowMisfit) {
  for (const double correlation : {0.0, 0.5, 0.8}) {
    std::vector<double> values = noise_of(2000, 2e-4, correlation, 7);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] += 2e-3 * std::sin(static_cast<double>(i) / 2000.0 * 6.0);
    const NoiseModel noise = fit_noise(values);
    // Standard errors at 2000 samples are 0.02 and about 5 %; four of them.
    EXPECT_NEAR(noise.correlation, correlation, 4.0 * noise.correlation_error);
    EXPECT_LT(noise.correlation_error, 0.06);
    EXPECT_NEAR(noise.sd, 2e-4, 0.2 * 2e-4);
  }
}

TEST(Noise, ASwingIsNotTakenForNoise) {
  std::vector<double> values = noise_of(400, 2e-4, 0.0, 13);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] += 6e-4 * std::sin(0.7 * static_cast<double>(i));
  // With the swing its spread would be 4.7e-4; the error at 400 samples is about 6 %.
  EXPECT_NEAR(fit_noise(values).sd, 2e-4, 0.5e-4);
}

TEST(Noise, WhitenedNoiseIsIndependentWithUnitVariance) {
  std::vector<double> values = noise_of(20000, 3.0, 0.7, 11);
  whiten({3.0, 0.7, 0.0, 1.0}, values.data(), values.size());
  double square = 0.0;
  double neighbour = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    square += values[i] * values[i];
    if (i > 0) neighbour += values[i] * values[i - 1];
  }
  const auto count = static_cast<double>(values.size());
  EXPECT_NEAR(square / count, 1.0, 4.0 * std::sqrt(2.0 / count));
  EXPECT_NEAR(neighbour / count, 0.0, 4.0 / std::sqrt(count));
}

TEST(Noise, RoughEstimateIsBlindToCurvatureAndJumps) {
  std::vector<double> values = noise_of(400, 1e-4, 0.0, 3);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = static_cast<double>(i) / 400.0;
    values[i] += t * t + (i > 200 ? 0.3 : 0.0);
  }
  // The median of 397 correlated values scatters by about 7 %.
  EXPECT_NEAR(rough_noise_sd(values), 1e-4, 0.25e-4);
}

}  // namespace
}  // namespace grouser::diagnosis
