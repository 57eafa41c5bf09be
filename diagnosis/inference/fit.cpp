// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/fit.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

// Derivatives are differences over this part of a prior's deviation: less, and the model's own
// steps in time show in them.
constexpr double kDifference = 0.05;
constexpr int kMostUpdates = 4;  // of the derivatives before they are taken anew

class Fitter {
 public:
  Fitter(const Study& study, const Coordinates& coordinates)
      : study_(study), coordinates_(coordinates) {}

  /// @param is_final whether the derivatives at the end are wanted
  Fit run(const Eigen::VectorXd& start, int most_steps, bool is_final) {
    Fit fit;
    fit.coordinates = coordinates_;
    fit.p = start;
    bound(fit.p);
    fit.residual.resize(static_cast<Index>(study_.rows()));
    evaluate(fit.p, fit.residual, true);
    double best = objective(fit.p, fit.residual);
    double damping = 1e-3;
    differentiate(fit.p, fit.jacobian);
    bool is_exact = true;
    int used = 0;
    for (int step = 0; step < 3 * most_steps && !fit.is_converged; ++step) {
      const Eigen::VectorXd p = fit.p;
      const Eigen::VectorXd residual = fit.residual;
      const bool is_worth_it = improve(fit, best, damping);
      if (is_worth_it && used < kMostUpdates) {
        ++used;
        // Derivatives cost a run each; Broyden's update costs none.
        const Eigen::VectorXd move = fit.p - p;
        const Eigen::VectorXd miss = residual - fit.residual - fit.jacobian * move;
        fit.jacobian += miss * (move.transpose() / move.squaredNorm());
        is_exact = false;
      } else if (!is_worth_it && is_exact) {
        fit.is_converged = true;
      } else {
        differentiate(fit.p, fit.jacobian);
        is_exact = true;
        used = 0;
      }
    }
    if (!is_exact && is_final) differentiate(fit.p, fit.jacobian);
    finish(fit);
    return fit;
  }

  /// Evidence where one undamped step would lead if the model were linear.
  double guess(const Eigen::VectorXd& start) {
    Fit fit;
    fit.p = start;
    bound(fit.p);
    fit.residual.resize(static_cast<Index>(study_.rows()));
    evaluate(fit.p, fit.residual, true);
    differentiate(fit.p, fit.jacobian);
    Eigen::MatrixXd normal = fit.jacobian.transpose() * fit.jacobian;
    normal.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(normal);
    const Eigen::VectorXd step = factor.solve(fit.jacobian.transpose() * fit.residual - fit.p);
    double half_log_det = 0.0;
    for (Index j = 0; j < fit.p.size(); ++j) half_log_det += std::log(factor.matrixL()(j, j));
    const double value = log_likelihood(fit.residual - fit.jacobian * step) -
                         0.5 * (fit.p + step).squaredNorm() - half_log_det;
    return std::isfinite(value) ? value : -1e300;
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

double guess_evidence(const Study& study, const Coordinates& coordinates,
                      const Eigen::VectorXd& start) {
  return Fitter(study, coordinates).guess(start);
}

Fit fit(const Study& study, const Coordinates& coordinates, const Eigen::VectorXd& start,
        int most_steps) {
  Eigen::VectorXd p = start;
  if (study.has_impacts()) {
    for (const std::size_t width : {33U, 9U, 3U}) {
      study.set_smoothing(width);
      p = Fitter(study, coordinates).run(p, most_steps, false).p;
    }
    study.set_smoothing(1);
  }
  return Fitter(study, coordinates).run(p, most_steps, true);
}

}  // namespace grouser::diagnosis
