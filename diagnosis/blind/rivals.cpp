// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/blind/rivals.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

bool is_single(const Candidate& c) {
  return c.hypothesis != nullptr && c.id.find('+') == std::string::npos;
}

/// Whether the squares are beyond what 99 % of chi-squared would be.
bool is_misfit(const Fit& fit) {
  const auto n = static_cast<double>(fit.residual.size());
  return fit.residual.squaredNorm() > n + 2.33 * std::sqrt(2.0 * n);
}

std::string by_rmse(const std::vector<Candidate>& all, const Fit& baseline) {
  if (!is_misfit(baseline)) return "";
  const Candidate* best = nullptr;
  for (const Candidate& c : all)
    if (is_single(c) && (best == nullptr || c.fit.log_likelihood > best->fit.log_likelihood))
      best = &c;
  return best != nullptr ? best->id : "";
}

std::string by_correlation(const Study& study, const std::vector<Candidate>& all,
                           const Fit& baseline) {
  if (!is_misfit(baseline)) return "";
  std::string name;
  double most = 0.0;
  for (const Candidate& c : all) {
    if (!is_single(c)) continue;
    Eigen::VectorXd p = Eigen::VectorXd::Zero(c.fit.p.size());
    p.head(baseline.p.size()) = baseline.p;
    for (Index j = baseline.p.size(); j < p.size(); ++j)
      p(j) = c.hypothesis->has_theory() ? 0.0 : c.fit.p(j);
    if (c.family == Family::kParameter) p = c.fit.p;
    Eigen::VectorXd residual(baseline.residual.size());
    for (std::size_t r = 0; r < study.observed().size(); ++r)
      study.residual(r, study.predict(r, c.fit.coordinates, p), residual);
    const Eigen::VectorXd change = baseline.residual - residual;
    const double size = change.norm() * baseline.residual.norm();
    const double alike = size > 0.0 ? std::abs(change.dot(baseline.residual)) / size : 0.0;
    if (alike <= most) continue;
    most = alike;
    name = c.id;
  }
  return name;
}

/// Second derivative of the first channel by local parabolas over 15 samples; of a speed, the first
/// derivative. Upward.
std::vector<double> accelerations(const Study& study, const Observed& o) {
  constexpr std::size_t kHalf = 7;
  const std::size_t n = o.times.size();
  std::vector<double> out(n, 0.0);
  const Signal signal = study.channels()[0];
  for (std::size_t i = kHalf; i + kHalf < n; ++i) {
    Eigen::MatrixXd columns(2 * kHalf + 1, 3);
    Eigen::VectorXd values(2 * kHalf + 1);
    for (std::size_t k = 0; k <= 2 * kHalf; ++k) {
      const double t = o.times[i + k - kHalf] - o.times[i];
      columns.row(static_cast<Index>(k)) << 1.0, t, 0.5 * t * t;
      values(static_cast<Index>(k)) = o.samples[0][i + k - kHalf];
    }
    const Eigen::VectorXd fit = columns.colPivHouseholderQr().solve(values);
    out[i] = signal == Signal::kGap ? fit(2) : signal == Signal::kSettlingSpeed ? -fit(1) : fit(1);
  }
  return out;
}

struct Library {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;  ///< forces over the buoyant weight
  std::vector<double> missing;            ///< what the baseline lacks
};

void add_rows(const Study& study, std::size_t r, Library& library) {
  const Observed& o = study.observed()[r];
  const Settings& s = o.known;
  const double density = s[Setting::kParticleDensity];
  const double excess = density - s[Setting::kFluidDensity];
  const double inertia = density + 0.5 * s[Setting::kAddedMass] * s[Setting::kFluidDensity];
  const std::vector<double> up = accelerations(study, o);
  const std::vector<double> drag = o.model->force_of(Setting::kViscosity, s);
  std::vector<std::vector<double>> columns;
  for (const Setting term : {Setting::kDragInertia, Setting::kAddedMass, Setting::kBasset,
                             Setting::kLubrication, Setting::kSideWall})
    if (study.terms()[index_of(term)] == 0.0) {
      columns.push_back(o.model->force_of(term, s));
      if (r == 0) library.names.push_back(entry_of(term).name);
    }
  if (r == 0) {
    library.names.push_back("parameter_particle_density");
    library.names.push_back("parameter_viscosity");
    library.names.push_back("release_force");
  }
  const std::size_t n = o.times.size();
  for (std::size_t i = 8; i + 8 < n; ++i) {
    const double since = o.times[i] - o.release;
    if (since <= 0.0 || o.weights[0][i] < 1.0 || drag[i] == 0.0) continue;
    std::vector<double> row;
    for (const std::vector<double>& column : columns) row.push_back(column[i]);
    row.push_back(-1.0);
    row.push_back(drag[i]);
    row.push_back(std::exp(-since / (0.1 * study.duration_of(r))));
    library.rows.push_back(row);
    library.missing.push_back(inertia * up[i] / (excess * s[Setting::kGravity]) - (drag[i] - 1.0));
  }
}

/// Least squares, small terms out, again.
std::string by_sindy(const Study& study) {
  Library library;
  for (std::size_t r = 0; r < study.observed().size(); ++r) add_rows(study, r, library);
  const std::size_t m = library.names.size();
  if (library.rows.size() < 2 * m) return "";
  std::vector<bool> is_in(m, true);
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(static_cast<Index>(m));
  for (int pass = 0; pass < 5; ++pass) {
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < m; ++k)
      if (is_in[k]) kept.push_back(k);
    if (kept.empty()) return "";
    Eigen::MatrixXd a(static_cast<Index>(library.rows.size()), static_cast<Index>(kept.size()));
    Eigen::VectorXd b(a.rows());
    for (Index i = 0; i < a.rows(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      for (Index k = 0; k < a.cols(); ++k)
        a(i, k) = library.rows[at][kept[static_cast<std::size_t>(k)]];
      b(i) = library.missing[at];
    }
    const Eigen::VectorXd x = a.colPivHouseholderQr().solve(b);
    sizes.setZero();
    for (Index k = 0; k < a.cols(); ++k) {
      const std::size_t name = kept[static_cast<std::size_t>(k)];
      // The share of the weight that the term carries, root mean square.
      sizes(static_cast<Index>(name)) =
          std::abs(x(k)) * a.col(k).norm() / std::sqrt(static_cast<double>(a.rows()));
      is_in[name] = sizes(static_cast<Index>(name)) > 0.01;
    }
  }
  Index best = 0;
  return sizes.maxCoeff(&best) > 0.01 ? library.names[static_cast<std::size_t>(best)] : "";
}

/// Draws of the linearised baseline's parameters.
std::string by_smc(const Study& study, const Fit& baseline) {
  constexpr int kDraws = 2000;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const Index n = baseline.p.size();
  if (n == 0) return "";
  const Eigen::MatrixXd square = baseline.jacobian.transpose() * baseline.jacobian;
  const Eigen::VectorXd slope = baseline.jacobian.transpose() * baseline.residual;
  std::vector<Eigen::VectorXd> draws;
  std::vector<double> misfits;
  for (int i = 0; i < kDraws; ++i) {
    Eigen::VectorXd p(n);
    for (Index j = 0; j < n; ++j) p(j) = normal(random);
    const Eigen::VectorXd move = p - baseline.p;
    misfits.push_back(0.5 * move.dot(square * move) - slope.dot(move));
    draws.push_back(p);
  }
  const double least = *std::min_element(misfits.begin(), misfits.end());
  double power = 1.0;
  std::vector<double> weights(draws.size());
  for (int pass = 0; pass < 200; ++pass, power *= 0.85) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < draws.size(); ++i) {
      weights[i] = std::exp(-power * (misfits[i] - least));
      sum += weights[i];
      squares += weights[i] * weights[i];
    }
    for (double& weight : weights) weight /= sum;
    if (sum * sum / squares > 0.2 * kDraws) break;
  }
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < draws.size(); ++i) mean += weights[i] * draws[i];
  Index best = 0;
  if (mean.cwiseAbs().maxCoeff(&best) < 2.0) return "";
  return std::string("parameter_") +
         entry_of(study.baseline()[static_cast<std::size_t>(best)].setting).name;
}

/// ln likelihood of values with unit noise and a smooth process of that size and length.
double process_likelihood(const std::vector<double>& values, double size, double length) {
  const auto n = static_cast<Index>(values.size());
  Eigen::MatrixXd k(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double x = static_cast<double>(i - j) / (length * static_cast<double>(n));
      k(i, j) = size * size * std::exp(-0.5 * x * x) + (i == j ? 1.0 : 0.0);
    }
  const Eigen::LLT<Eigen::MatrixXd> factor(k);
  const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  double value = -0.5 * y.dot(factor.solve(y));
  for (Index i = 0; i < n; ++i) value -= std::log(factor.matrixL()(i, i));
  return value;
}

std::string by_gp(const Study& study, const Fit& baseline) {
  double gain = 0.0;
  for (const Observed& o : study.observed())
    for (std::size_t c = 0; c < o.noise.size(); ++c) {
      std::vector<double> values;
      for (std::size_t i = 0; i < o.times.size(); i += 3)
        values.push_back(baseline.residual(static_cast<Index>(o.first + c * o.times.size() + i)));
      const double none = process_likelihood(values, 0.0, 1.0);
      double best = none;
      for (const double size : {0.5, 2.0, 8.0})
        for (const double length : {0.05, 0.2})
          best = std::max(best, process_likelihood(values, size, length) - std::log(6.0));
      gain += best - none;
    }
  return gain > std::log(100.0) ? "unknown" : "";
}

}  // namespace

std::string rivals_of(const SeriesRecording& recording, const Baseline& baseline,
                      const Diagnosis& d) {
  Study study(recording, baseline.terms);
  estimate_noise(study);
  const auto none = std::find_if(d.candidates.begin(), d.candidates.end(),
                                 [](const Candidate& c) { return c.id == "baseline"; });
  const nlohmann::ordered_json out{{"rmse", by_rmse(d.candidates, none->fit)},
                                   {"correlation", by_correlation(study, d.candidates, none->fit)},
                                   {"sindy", by_sindy(study)},
                                   {"smc", by_smc(study, none->fit)},
                                   {"gp", by_gp(study, none->fit)}};
  return out.dump() + "\n";
}

}  // namespace grouser::diagnosis
