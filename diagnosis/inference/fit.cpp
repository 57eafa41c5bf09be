// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/fit.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

constexpr double kDifference = 1e-2;  // of a prior's standard deviation

class Fitter {
 public:
  Fitter(const Study& study, const Coordinates& coordinates)
      : study_(study), coordinates_(coordinates) {}

  Fit run(const Eigen::VectorXd& start, int most_steps) {
    Fit fit;
    fit.coordinates = coordinates_;
    fit.p = start;
    bound(fit.p);
    fit.residual.resize(static_cast<Index>(study_.rows()));
    evaluate(fit.p, fit.residual, true);
    double best = objective(fit.p, fit.residual);
    double damping = 1e-3;
    for (int step = 0; step < most_steps && !fit.is_converged; ++step) {
      differentiate(fit.p, fit.jacobian);
      fit.is_converged = !improve(fit, best, damping);
    }
    if (!fit.is_converged) differentiate(fit.p, fit.jacobian);
    finish(fit);
    return fit;
  }

 private:
  void bound(Eigen::VectorXd& p) const {
    for (std::size_t j = 0; j < coordinates_.size(); ++j) {
      double& value = p(static_cast<Index>(j));
      value = std::clamp(value, coordinates_[j].is_positive ? 0.0 : -30.0, 30.0);
    }
  }

  double objective(const Eigen::VectorXd& p, const Eigen::VectorXd& residual) const {
    const double value = -log_likelihood(residual) + 0.5 * p.squaredNorm();
    return std::isfinite(value) ? value : INFINITY;
  }

  void evaluate(const Eigen::VectorXd& p, Eigen::VectorXd& residual, bool keep) {
    if (keep) base_.resize(study_.observed().size());
    for (std::size_t r = 0; r < study_.observed().size(); ++r) {
      std::vector<double> predicted = study_.predict(r, coordinates_, p);
      study_.residual(r, predicted, residual);
      if (keep) base_[r] = std::move(predicted);
    }
  }

  void differentiate(const Eigen::VectorXd& p, Eigen::MatrixXd& jacobian) {
    jacobian.setZero(static_cast<Index>(study_.rows()), p.size());
    Eigen::VectorXd moved = p;
    for (std::size_t j = 0; j < coordinates_.size(); ++j) {
      const auto at = static_cast<Index>(j);
      moved(at) = p(at) + kDifference;
      for (const std::size_t r : coordinates_[j].conditions) {
        std::vector<double> predicted = study_.predict(r, coordinates_, moved);
        for (std::size_t i = 0; i < predicted.size(); ++i)
          predicted[i] = (predicted[i] - base_[r][i]) / kDifference;
        study_.whiten(r, predicted.data());
        jacobian.col(at).segment(static_cast<Index>(study_.observed()[r].first),
                                 static_cast<Index>(predicted.size())) =
            Eigen::Map<Eigen::VectorXd>(predicted.data(), static_cast<Index>(predicted.size()));
      }
      moved(at) = p(at);
    }
  }

  /// One damped step. @return whether it was worth it
  bool improve(Fit& fit, double& best, double& damping) {
    Eigen::MatrixXd normal = fit.jacobian.transpose() * fit.jacobian;
    normal.diagonal().array() += 1.0;
    const Eigen::VectorXd slope = fit.jacobian.transpose() * fit.residual - fit.p;
    for (int attempt = 0; attempt < 8; ++attempt) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + damping;
      Eigen::VectorXd p = fit.p + damped.llt().solve(slope);
      bound(p);
      Eigen::VectorXd residual(fit.residual.size());
      const std::vector<std::vector<double>> before = base_;
      evaluate(p, residual, true);
      const double value = objective(p, residual);
      if (value < best) {
        const double gain = best - value;
        fit.p = p;
        fit.residual = residual;
        best = value;
        damping = std::max(1e-6, damping * 0.2);
        return gain > 1e-3;
      }
      base_ = before;
      damping *= 10.0;
    }
    return false;
  }

  void finish(Fit& fit) const {
    fit.log_likelihood = log_likelihood(fit.residual);
    Eigen::MatrixXd normal = fit.jacobian.transpose() * fit.jacobian;
    normal.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    fit.covariance = factor.solve(Eigen::MatrixXd::Identity(fit.p.size(), fit.p.size()));
    double half_log_det = 0.0;
    for (Index j = 0; j < fit.p.size(); ++j) half_log_det += std::log(factor.matrixL()(j, j));
    fit.log_evidence = fit.log_likelihood - 0.5 * fit.p.squaredNorm() - half_log_det;
    for (std::size_t j = 0; j < coordinates_.size(); ++j) {
      if (!coordinates_[j].is_positive) continue;
      // The prior has twice the density; of the posterior only what is above 0 counts.
      const auto at = static_cast<Index>(j);
      const double z = fit.p(at) / std::sqrt(fit.covariance(at, at));
      fit.log_evidence += std::log(std::max(1e-12, std::erfc(-z / std::sqrt(2.0))));
    }
    if (!std::isfinite(fit.log_evidence)) fit.log_evidence = -1e300;
  }

  const Study& study_;
  const Coordinates& coordinates_;
  std::vector<std::vector<double>> base_;
};

}  // namespace

double Fit::deviation(std::size_t coordinate) const {
  const auto at = static_cast<Index>(coordinate);
  const double sd = std::sqrt(covariance(at, at));
  const Coordinate& c = coordinates[coordinate];
  return c.is_log ? value(coordinate) * c.sd * sd : c.sd * sd;
}

double log_likelihood(const Eigen::VectorXd& residual) { return -0.5 * residual.squaredNorm(); }

Fit fit(const Study& study, const Coordinates& coordinates, const Eigen::VectorXd& start,
        int most_steps) {
  study.set_calm(true);
  const Fit coarse = Fitter(study, coordinates).run(start, most_steps);
  study.set_calm(false);
  return Fitter(study, coordinates).run(coarse.p, most_steps);
}

}  // namespace grouser::diagnosis
