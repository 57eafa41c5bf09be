// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/plan/planner.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace grouser {
namespace {

// Cost and mean time between failures [s], from cheap and safe to dear and bad.
constexpr std::array<std::pair<double, double>, 5> kMachines{
    {{1.0, 86400.0}, {30.0, 86400.0}, {300.0, 86400.0}, {600.0, 7200.0}, {1200.0, 3600.0}}};

// The interval with the least expected time, found by trying, in steps of a thousandth.
double best_interval(double cost, double mtbf) {
  double best = cost;
  for (double t = 0.05 * cost; t < 4.0 * mtbf; t *= 1.001)
    if (expected_wall_time(1.0, t, cost, 0.0, mtbf) <
        expected_wall_time(1.0, best, cost, 0.0, mtbf))
      best = t;
  return best;
}

TEST(Planner, YoungsIntervalIsHisEquation) {
  EXPECT_DOUBLE_EQ(young_interval(50.0, 10000.0), 1000.0);
  EXPECT_DOUBLE_EQ(young_interval(0.0, 10000.0), 0.0);
}

// Daly's Fig. 3: the higher order stays within some parts in a thousand of the least wall time.
TEST(Planner, DalysIntervalCostsNextToNoMoreThanTheBestOne) {
  for (const auto& [cost, mtbf] : kMachines) {
    const double least = expected_wall_time(1.0, best_interval(cost, mtbf), cost, 0.0, mtbf);
    EXPECT_LT(expected_wall_time(1.0, daly_interval(cost, mtbf), cost, 0.0, mtbf), 1.002 * least)
        << cost << " of " << mtbf;
  }
}

TEST(Planner, DalyComesToYoungWhenCheckpointsCostLittle) {
  // The correction is a third of sqrt(C / 2M), less C itself: 0.1 % and 0.2 % here.
  EXPECT_NEAR(daly_interval(1.0, 86400.0) / young_interval(1.0, 86400.0), 1.0, 3e-3);
  EXPECT_LT(daly_interval(1200.0, 3600.0), young_interval(1200.0, 3600.0));
}

TEST(Planner, ACheckpointDearerThanTwoFailuresIsWrittenOncePerFailure) {
  EXPECT_DOUBLE_EQ(daly_interval(7200.0, 3600.0), 3600.0);
  EXPECT_DOUBLE_EQ(daly_interval(9000.0, 3600.0), 3600.0);
}

TEST(Planner, ExpectedTimeIsTheWorkItselfWhenNothingFailsOrCosts) {
  EXPECT_NEAR(expected_wall_time(1000.0, 10.0, 0.0, 0.0, 1e12), 1000.0, 1e-6);
  EXPECT_NEAR(expected_wall_time(1000.0, 10.0, 1.0, 0.0, 1e12), 1100.0, 1e-6);
}

TEST(Planner, LittleExperienceDecidesLittle) {
  EXPECT_DOUBLE_EQ(mtbf_after(0.0, 0), 86400.0);
  EXPECT_GT(mtbf_after(3600.0, 1), 0.5 * 86400.0);
  EXPECT_NEAR(mtbf_after(1e8, 1000), 1e5, 300.0);
}

TEST(Planner, NinetyFiveOfAHundredDoNotExceedThePercentile) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  EXPECT_DOUBLE_EQ(percentile95(values), 95.0);
  EXPECT_DOUBLE_EQ(percentile95({3.0}), 3.0);
  EXPECT_DOUBLE_EQ(percentile95({}), 0.0);
}

TEST(Planner, NothingIsPlannedBeforeAnythingIsMeasured) {
  EXPECT_DOUBLE_EQ(checkpoint_seconds({}), 0.0);
  EXPECT_DOUBLE_EQ(job_walltime(0.0, 28800.0, {}), 28800.0);
}

TEST(Planner, TheRestOfARunGetsAShortJobAndNeverALongerOneThanAllowed) {
  const Measured measured{{20.0}, 1e5, 1};
  EXPECT_DOUBLE_EQ(job_walltime(600.0, 28800.0, measured), 1800.0);  // 900 + 120 + 40 s
  EXPECT_DOUBLE_EQ(job_walltime(1e6, 28800.0, measured), 28800.0);
  EXPECT_NEAR(checkpoint_seconds(measured), daly_interval(20.0, (1e5 + 86400.0) / 2.0), 1e-9);
}

}  // namespace
}  // namespace grouser
