// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace grouser {
namespace {

/// First-order autoregressive series with unit innovations of variance 1/3; its mean over n values
/// has variance 1 / (3 n (1 - memory)^2) for n much larger than the memory.
std::vector<double> correlated_series(std::size_t count, double memory, unsigned seed) {
  std::mt19937 engine(seed);
  std::vector<double> values;
  double value = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    value = memory * value + 2.0 * static_cast<double>(engine()) / 4294967296.0 - 1.0;
    values.push_back(value);
  }
  return values;
}

double mean_error_over_theory(double memory) {
  constexpr std::size_t kCount = 4000;
  constexpr unsigned kSeries = 200;
  double squares = 0.0;
  for (unsigned seed = 1; seed <= kSeries; ++seed) {
    const double error = batch_means(correlated_series(kCount, memory, seed)).error;
    squares += error * error;
  }
  const double theory = 1.0 / (3.0 * kCount * (1.0 - memory) * (1.0 - memory));
  return std::sqrt(squares / kSeries / theory);
}

// With 10 batches, 200 series give a variance known to sqrt(2 / (9 * 200)) = 3.3 %, its root to 1.7
// %.
TEST(BatchMeans, ErrorOfIndependentValuesIsTheTextbookOne) {
  EXPECT_NEAR(mean_error_over_theory(0.0), 1.0, 0.06);
}

// A memory of 0.9 is about 20 values; batches of 400 leave a bias of some per cent.
TEST(BatchMeans, ErrorKnowsThatNeighboursAreAlike) {
  EXPECT_NEAR(mean_error_over_theory(0.9), 1.0, 0.1);
}

TEST(BatchMeans, LeavesOutWhatIsNoNumber) {
  const Estimate estimate = batch_means({1.0, kNaN, 3.0, kNaN});
  EXPECT_DOUBLE_EQ(estimate.mean, 2.0);
  EXPECT_EQ(estimate.count, 2u);
  EXPECT_TRUE(std::isnan(estimate.error)) << "one batch says nothing about scatter";
}

TEST(BatchMeans, NothingGivesNothing) {
  EXPECT_TRUE(std::isnan(batch_means({}).mean));
  EXPECT_TRUE(std::isnan(batch_means({kNaN}).mean));
  EXPECT_EQ(batch_means({kNaN}).count, 0u);
}

TEST(BatchMeans, ConstantSeriesHasNoError) {
  EXPECT_DOUBLE_EQ(batch_means(std::vector<double>(57, 0.25)).error, 0.0);
}

TEST(BatchMeans, TellsADriftFromNoise) {
  std::vector<double> values = correlated_series(400, 0.8, 3);
  for (double& value : values) value += 10.0;
  EXPECT_FALSE(batch_means(values).is_drifting());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.01 * static_cast<double>(i);
  const Estimate estimate = batch_means(values);
  EXPECT_TRUE(estimate.is_drifting());
  EXPECT_NEAR(estimate.drift, 4.0, 4.0 * estimate.drift_error);
}

TEST(BatchMeans, ASmallDriftOfAQuietSeriesIsSteady) {
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back(1.0 + 0.0005 * i);
  EXPECT_NEAR(batch_means(values).drift, 0.05, 1e-9);
  EXPECT_FALSE(batch_means(values).is_drifting()) << "under a tenth of the mean";
}

TEST(Scatter, UsesOneLessThanTheNumberOfValues) {
  const Scatter scatter = scatter_of({1.0, 3.0, kNaN});
  EXPECT_DOUBLE_EQ(scatter.mean, 2.0);
  EXPECT_DOUBLE_EQ(scatter.deviation, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(scatter.low, 1.0);
  EXPECT_DOUBLE_EQ(scatter.high, 3.0);
  EXPECT_TRUE(std::isnan(scatter_of({1.0}).deviation));
}

TEST(Quantile, IsAValueOfTheSample) {
  EXPECT_DOUBLE_EQ(quantile_of({5.0, 1.0, 3.0, kNaN}, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quantile_of({5.0, 1.0, 3.0}, 1.0), 5.0);
  EXPECT_TRUE(std::isnan(quantile_of({}, 0.5)));
}

}  // namespace
}  // namespace grouser
