// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/detect.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <random>

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

std::vector<ScanCell> windows_of(const Study& study) {
  std::vector<ScanCell> cells;
  for (std::size_t r = 0; r < study.observed().size(); ++r) {
    const std::size_t n = study.observed()[r].times.size();
    for (std::size_t c = 0; c < study.channels().size(); ++c)
      for (const std::size_t part : {16U, 8U, 4U, 2U}) {
        const std::size_t length = std::max<std::size_t>(2, n / part);
        for (std::size_t from = 0; from + length <= n; from += std::max<std::size_t>(1, length / 2))
          cells.push_back({r, c, from, from + length, 0.0});
      }
  }
  return cells;
}

/// Fills z of every cell from running sums. @return the largest |z|
double scan(const Study& study, const Eigen::VectorXd& residual, std::vector<ScanCell>& cells) {
  std::vector<double> sums(static_cast<std::size_t>(residual.size()) + 1, 0.0);
  for (Index i = 0; i < residual.size(); ++i)
    sums[static_cast<std::size_t>(i) + 1] = sums[static_cast<std::size_t>(i)] + residual(i);
  double largest = 0.0;
  for (ScanCell& cell : cells) {
    const Observed& o = study.observed()[cell.condition];
    const std::size_t first = o.first + cell.channel * o.times.size();
    cell.z = (sums[first + cell.to] - sums[first + cell.from]) /
             std::sqrt(static_cast<double>(cell.to - cell.from));
    largest = std::max(largest, std::abs(cell.z));
  }
  return largest;
}

/// Whitened noise as it would come out if the noise were not quite as estimated.
class NoiseDrawer {
 public:
  NoiseDrawer(const Study& study, unsigned seed) : study_(study), random_(seed) {}

  void draw(Eigen::VectorXd& out) {
    for (const Observed& o : study_.observed())
      for (std::size_t c = 0; c < o.noise.size(); ++c) {
        const auto n = static_cast<Index>(o.times.size());
        const Index first = static_cast<Index>(o.first) + static_cast<Index>(c) * n;
        const double off = std::clamp(o.noise[c].correlation_error * normal_(random_), -0.4, 0.4);
        const double scale = 1.0 + normal_(random_) / std::sqrt(2.0 * o.noise[c].freedom);
        const double fresh = scale * std::sqrt(1.0 - off * off);
        double before = scale * normal_(random_);
        for (Index i = 0; i < n; ++i) {
          out(first + i) = before;
          before = off * before + fresh * normal_(random_);
        }
      }
  }
  double normal() { return normal_(random_); }

 private:
  const Study& study_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

struct Statistics {
  double global = 0.0;
  double scan = 0.0;
  double stress = 0.0;
};

double chance(const std::vector<double>& draws, double value) {
  const auto above =
      std::count_if(draws.begin(), draws.end(), [&](double d) { return d >= value; });
  return (1.0 + static_cast<double>(above)) / (1.0 + static_cast<double>(draws.size()));
}

}  // namespace

Detection detect(const Study& study, const Fit& fit, int draws, unsigned seed) {
  Detection found;
  found.cells = windows_of(study);
  const Statistics seen{fit.p.squaredNorm() - 2.0 * log_likelihood(fit.residual),
                        scan(study, fit.residual, found.cells), fit.p.squaredNorm()};
  Eigen::MatrixXd normal = fit.jacobian.transpose() * fit.jacobian;
  normal.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(normal);
  std::vector<double> global, largest, stress;
  std::vector<ScanCell> cells = found.cells;
  NoiseDrawer drawer(study, seed);
  Eigen::VectorXd noise(fit.residual.size());
  Eigen::VectorXd parameters(fit.p.size());
  for (int i = 0; i < draws; ++i) {
    drawer.draw(noise);
    for (Index j = 0; j < parameters.size(); ++j) parameters(j) = drawer.normal();
    // Least squares on (noise, prior) stacked: what the fit leaves of them.
    const Eigen::VectorXd moved = factor.solve(fit.jacobian.transpose() * noise - parameters);
    const Eigen::VectorXd residual = noise - fit.jacobian * moved;
    const double distance = (parameters + moved).squaredNorm();
    global.push_back(distance - 2.0 * log_likelihood(residual));
    largest.push_back(scan(study, residual, cells));
    stress.push_back(distance);
  }
  found.p_global = chance(global, seen.global);
  found.p_scan = chance(largest, seen.scan);
  found.p_stress = chance(stress, seen.stress);
  found.p = std::min(1.0, 3.0 * std::min({found.p_global, found.p_scan, found.p_stress}));
  const auto at = largest.begin() + static_cast<std::ptrdiff_t>(0.99 * double(largest.size()));
  std::nth_element(largest.begin(), at, largest.end());
  found.threshold = *at;
  found.draws = std::move(largest);
  std::sort(found.cells.begin(), found.cells.end(),
            [](const ScanCell& a, const ScanCell& b) { return std::abs(a.z) > std::abs(b.z); });
  return found;
}

}  // namespace grouser::diagnosis
