// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "diagnosis/inference/study.hpp"

namespace grouser::diagnosis {

/// A model fitted with its priors.
struct Fit {
  Coordinates coordinates;
  Eigen::VectorXd p;           ///< most probable, in units of the priors
  Eigen::VectorXd residual;    ///< recorded minus predicted, whitened, all conditions
  Eigen::MatrixXd jacobian;    ///< of the prediction with respect to p, whitened
  Eigen::MatrixXd covariance;  ///< of p, by the curvature at the most probable
  double log_likelihood = 0.0;
  double log_evidence = 0.0;  ///< Laplace
  bool is_converged = false;

  double value(std::size_t coordinate) const {
    return coordinates[coordinate].value(p(static_cast<Eigen::Index>(coordinate)));
  }
  double deviation(std::size_t coordinate) const;  ///< standard deviation of value()
};

/// Most probable parameters by Gauss-Newton with Levenberg-Marquardt damping from `start`, and the
/// evidence by Laplace's method: priors are standard normal in p, so
///   ln Z = ln L - p.p/2 - ln det(J'J + 1)/2 + n ln 2   (n coordinates that are half a normal).
/// Residuals of curves that jump are smoothed at first, until the jumps fall in their places.
/// The likelihood is normal with the noise as estimated: a heavier tail would let a fit give up a
/// whole channel, which is what a misfit must not do. Local.
Fit fit(const Study& study, const Coordinates& coordinates, const Eigen::VectorXd& start,
        int most_steps = 20);

/// Evidence after a single undamped step from `start`, the model taken as linear there. Local.
double guess_evidence(const Study& study, const Coordinates& coordinates,
                      const Eigen::VectorXd& start);

/// ln L of whitened residuals, up to what all models share. Local.
double log_likelihood(const Eigen::VectorXd& residual);

}  // namespace grouser::diagnosis
