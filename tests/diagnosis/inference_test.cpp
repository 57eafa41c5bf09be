// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/inference/detect.hpp"
#include "tests/diagnosis/linear_study.hpp"

namespace grouser::diagnosis {
namespace {

double log_det(const Eigen::MatrixXd& positive) {
  const Eigen::MatrixXd root = positive.llt().matrixL();
  return 2.0 * root.diagonal().array().log().sum();
}

Fit fit_from_priors(const LinearStudy& linear) {
  return fit(linear.study, linear.coordinates, Eigen::VectorXd::Zero(2));
}

TEST(Fit, OfALinearModelIsTheClosedFormOfItsPosterior) {
  LinearStudy linear(0.2, 0.6);
  std::mt19937_64 random(3);
  linear.draw(random);
  const Fit found = fit_from_priors(linear);
  const Eigen::MatrixXd precision =
      linear.design.transpose() * linear.noise.inverse() * linear.design +
      linear.prior_covariance().inverse();
  const Eigen::MatrixXd covariance = precision.inverse();
  const Eigen::VectorXd mean =
      covariance * (linear.design.transpose() * linear.noise.inverse() * linear.recorded() +
                    linear.prior_covariance().inverse() * linear.prior_mean());
  // Steps end when the objective gains less than 1e-3, and the damping then is below 1e-3.
  for (std::size_t j = 0; j < 2; ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    const double deviation = std::sqrt(covariance(at, at));
    EXPECT_NEAR(found.value(j), mean(at), 1e-4 * deviation);
    EXPECT_NEAR(found.deviation(j), deviation, 1e-6 * deviation);
  }
}

TEST(Fit, LaplaceEvidenceOfALinearModelIsExact) {
  LinearStudy linear(0.2, 0.6);
  std::mt19937_64 random(4);
  linear.draw(random);
  const Fit found = fit_from_priors(linear);
  // Data given the model alone: normal with the noise and the priors' spread together. What the
  // noise's own determinant adds is common to all models and left out of Fit.
  const Eigen::MatrixXd all =
      linear.noise + linear.design * linear.prior_covariance() * linear.design.transpose();
  const Eigen::VectorXd off = linear.recorded() - linear.design * linear.prior_mean();
  const double exact =
      -0.5 * off.dot(all.llt().solve(off)) - 0.5 * (log_det(all) - log_det(linear.noise));
  EXPECT_NEAR(found.log_evidence, exact, 1e-6);
}

TEST(Fit, EvidenceOfAHalfNormalPriorIsTheIntegralAboveZero) {
  LinearStudy linear(2.0, 0.0);
  std::mt19937_64 random(5);
  linear.draw(random);
  linear.coordinates[0].is_positive = true;
  linear.coordinates[0].mean = 0.0;
  linear.coordinates.pop_back();
  linear.record(linear.recorded().array() + 0.5);
  const Fit found = fit(linear.study, linear.coordinates, Eigen::VectorXd::Ones(1));
  // By the trapezoidal rule over p in 0..8; the likelihood is that of independent noise.
  double sum = 0.0;
  constexpr double kStep = 1e-4;
  const double before = linear.recorded().squaredNorm() / 4.0;
  for (int i = 0; i <= 80000; ++i) {
    const double p = kStep * i;
    const double level = 0.7 * p;
    const double square = before - level * linear.recorded().sum() / 2.0 + 16.0 * level * level;
    sum += (i == 0 ? 0.5 : 1.0) * kStep * 2.0 / std::sqrt(2.0 * M_PI) *
           std::exp(-0.5 * p * p - 0.5 * (square - before));
  }
  ASSERT_GT(found.p(0), 0.0);
  EXPECT_NEAR(found.log_evidence, std::log(sum) - 0.5 * before, 1e-5);
}

/// Alarms on draws of the model itself, of each statistic at 5 % and of all together at 5 %.
struct Alarms {
  int global = 0;
  int scan = 0;
  int stress = 0;
  int any = 0;
  double mean_global = 0.0;
  double mean_scan = 0.0;
  double mean_stress = 0.0;
};

Alarms alarms_of_the_model_itself(int trials) {
  Alarms alarms;
  LinearStudy linear(0.2, 0.6);
  std::mt19937_64 random(6);
  for (int i = 0; i < trials; ++i) {
    linear.draw(random);
    const Detection d =
        detect(linear.study, fit_from_priors(linear), 199, 100U + static_cast<unsigned>(i));
    alarms.global += d.p_global <= 0.05;
    alarms.scan += d.p_scan <= 0.05;
    alarms.stress += d.p_stress <= 0.05;
    alarms.any += d.p <= 0.05;
    alarms.mean_global += d.p_global / trials;
    alarms.mean_scan += d.p_scan / trials;
    alarms.mean_stress += d.p_stress / trials;
  }
  return alarms;
}

TEST(Detection, OfTheModelItselfRaisesAlarmsAtTheStatedRate) {
  constexpr int kTrials = 200;
  const Alarms alarms = alarms_of_the_model_itself(kTrials);
  // Rank among 199 draws of the same kind: 5 % each, exactly. Four binomial standard deviations of
  // sqrt(200 * 0.05 * 0.95) = 3.08 about 10 are passed once in 10^4.
  for (const int count : {alarms.global, alarms.scan, alarms.stress}) EXPECT_NEAR(count, 10, 12.3);
  EXPECT_GT(alarms.global, 0);
  EXPECT_GT(alarms.scan, 0);
  EXPECT_GT(alarms.stress, 0);
  // Chances are even between 0 and 1: standard error of their mean sqrt(1/12/200) = 0.0204, four of
  // them. Fails when the draws are not projected as the fit is.
  for (const double mean : {alarms.mean_global, alarms.mean_scan, alarms.mean_stress})
    EXPECT_NEAR(mean, 0.5025, 0.082);
  // Three times the least is at most the stated 5 %.
  EXPECT_LE(alarms.any, 10 + 12.3);
}

TEST(Detection, SeesAShiftOfTwoNoiseDeviationsOverAQuarterAndWhere) {
  LinearStudy linear(0.2, 0.0);
  std::mt19937_64 random(7);
  for (int i = 0; i < 20; ++i) {
    linear.draw(random);
    Eigen::VectorXd samples = linear.recorded();
    samples.segment(24, 16).array() += 0.4;
    linear.record(samples);
    const Detection d = detect(linear.study, fit_from_priors(linear), 999, 8);
    // 16 samples at 2 deviations are z = 8; the level eats a quarter of it, which leaves 6, and
    // noise moves it by 1. Windows pass their threshold of about 3.3 then in all but 1 of 300.
    EXPECT_TRUE(d.is_mismatch(0.01)) << i;
    EXPECT_NEAR(d.threshold, 3.3, 0.5);
    EXPECT_LT(d.cells[0].from, 40U) << i;
    EXPECT_GT(d.cells[0].to, 24U) << i;
  }
}

TEST(Detection, IsSilentOnAShiftThatAParameterTakesUp) {
  LinearStudy linear(0.2, 0.0);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  int alarms = 0;
  for (int i = 0; i < 50; ++i) {
    // The level is half a deviation of its prior off, 1.75 of the noise on every sample.
    Eigen::VectorXd samples = linear.design * linear.prior_mean();
    for (double& sample : samples) sample += 0.35 + 0.2 * normal(random);
    linear.record(samples);
    alarms += detect(linear.study, fit_from_priors(linear), 199, 50U + static_cast<unsigned>(i))
                  .is_mismatch(0.05);
  }
  // 2.5 at most are expected at 5 %; four binomial standard deviations of 1.54 above.
  EXPECT_LE(alarms, 8);
}

}  // namespace
}  // namespace grouser::diagnosis
