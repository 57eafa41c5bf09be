// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>

#include <memory>
#include <random>

#include "diagnosis/inference/study.hpp"

namespace grouser::diagnosis {

/// A model that is linear in two settings, so that all of the inference has a closed form:
/// value(t) = ambient_flow + release_force * (t - 1/2) over t in 0..1.
class LinearModel final : public Model {
 public:
  explicit LinearModel(std::vector<double> times) : times_(std::move(times)) {}

  std::vector<double> run(const Settings& settings, const LatentForce&) const override {
    std::vector<double> out;
    for (const double t : times_)
      out.push_back(settings[Setting::kAmbientFlow] + settings[Setting::kReleaseForce] * (t - 0.5));
    return out;
  }
  std::vector<double> force_of(Setting, const Settings&) const override {
    return std::vector<double>(times_.size(), 0.0);
  }

 private:
  std::vector<double> times_;
};

/// One condition of 64 samples seen through LinearModel, with noise that is known exactly.
struct LinearStudy {
  static constexpr Eigen::Index kCount = 64;

  LinearStudy(double noise_sd, double correlation)
      : design(kCount, 2), noise(kCount, kCount), study(recording(), default_values()) {
    Observed& o = study.observed()[0];
    o.model = std::make_unique<LinearModel>(o.times);
    o.weights[0].assign(kCount, 1.0);
    o.noise[0] = {noise_sd, correlation, 0.0, 1e12};
    for (Eigen::Index i = 0; i < kCount; ++i) {
      design(i, 0) = 1.0;
      design(i, 1) = o.times[static_cast<std::size_t>(i)] - 0.5;
      for (Eigen::Index k = 0; k < kCount; ++k)
        noise(i, k) = noise_sd * noise_sd * std::pow(correlation, std::abs(double(i - k)));
    }
    Coordinate level;
    level.label = "level";
    level.setting = Setting::kAmbientFlow;
    level.conditions = {0};
    level.mean = 0.3;
    level.sd = 0.7;
    Coordinate slope = level;
    slope.label = "slope";
    slope.setting = Setting::kReleaseForce;
    slope.mean = -0.2;
    slope.sd = 1.5;
    coordinates = {level, slope};
  }

  static SeriesRecording recording() {
    SeriesRecording r;
    r.channels.resize(1);
    Condition c;
    c.name = "A";
    for (Eigen::Index i = 0; i < kCount; ++i)
      c.times.push_back(static_cast<double>(i) / static_cast<double>(kCount - 1));
    c.samples.emplace_back(c.times.size(), 0.0);
    r.conditions.push_back(c);
    return r;
  }

  Eigen::VectorXd prior_mean() const {
    return Eigen::Vector2d(coordinates[0].mean, coordinates[1].mean);
  }
  Eigen::MatrixXd prior_covariance() const {
    return Eigen::Vector2d(std::pow(coordinates[0].sd, 2), std::pow(coordinates[1].sd, 2))
        .asDiagonal();
  }

  /// Records the model at values drawn from the priors, plus noise of the stated kind.
  void draw(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    Eigen::VectorXd values = prior_mean();
    for (Eigen::Index j = 0; j < 2; ++j)
      values(j) += coordinates[static_cast<std::size_t>(j)].sd * normal(random);
    Eigen::VectorXd independent(kCount);
    for (double& value : independent) value = normal(random);
    const Eigen::MatrixXd root = noise.llt().matrixL();
    record(design * values + root * independent);
  }
  void record(const Eigen::VectorXd& samples) {
    study.observed()[0].samples[0].assign(samples.begin(), samples.end());
  }
  Eigen::VectorXd recorded() const {
    return Eigen::Map<const Eigen::VectorXd>(study.observed()[0].samples[0].data(), kCount);
  }

  Eigen::MatrixXd design;
  Eigen::MatrixXd noise;  ///< covariance
  Study study;
  Coordinates coordinates;
};

}  // namespace grouser::diagnosis
