// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/screen.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/hypotheses/table.hpp"

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

constexpr double kLatentSpreads[] = {0.01, 0.05, 0.2};

/// Whether the cause could act here and is not in the baseline already.
bool is_open(const Study& study, const Hypothesis& h) {
  const Settings& known = study.observed()[0].known;
  if (h.family == Family::kPhysics) {
    if (study.terms()[index_of(h.free[0].setting)] != 0.0) return false;
    if (h.free[0].setting == Setting::kSideWall)
      return std::any_of(study.observed().begin(), study.observed().end(),
                         [](const Observed& o) { return o.known[Setting::kContainerWidth] > 0.0; });
  }
  if (h.family == Family::kParameter)
    return std::any_of(study.baseline().begin(), study.baseline().end(),
                       [&](const Coordinate& c) { return c.setting == h.widened; });
  if (h.family == Family::kImitator && h.free[0].setting == Setting::kReleaseForce)
    return known[Setting::kReleaseSpeed] == 0.0;
  return true;
}

Eigen::VectorXd start_of(const Coordinates& coordinates, const Eigen::VectorXd& baseline,
                         double own) {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(static_cast<Index>(coordinates.size()));
  p.head(baseline.size()) = baseline;
  for (Index j = baseline.size(); j < p.size(); ++j)
    p(j) = coordinates[static_cast<std::size_t>(j)].is_log ? 0.0 : own;
  return p;
}

/// Best of several starts.
Fit best_fit(const Study& study, const Coordinates& coordinates,
             const std::vector<Eigen::VectorXd>& starts) {
  Fit best;
  best.log_evidence = -INFINITY;
  for (const Eigen::VectorXd& start : starts) {
    Fit now = fit(study, coordinates, start, 20);
    if (now.log_evidence > best.log_evidence) best = std::move(now);
  }
  return best;
}

std::vector<Eigen::VectorXd> starts_of(const Study& study, const Hypothesis& h,
                                       const Coordinates& coordinates, const Fit& baseline) {
  if (h.has_theory()) {
    const Eigen::VectorXd means = Eigen::VectorXd::Zero(baseline.p.size());
    return {start_of(coordinates, means, 0.0)};
  }
  if (h.family == Family::kParameter) {
    // The same values, counted in wider priors.
    Eigen::VectorXd p = baseline.p;
    for (std::size_t j = 0; j < coordinates.size(); ++j)
      p(static_cast<Index>(j)) *= study.baseline()[j].sd / coordinates[j].sd;
    return {p};
  }
  if (h.free[0].setting == Setting::kVibration) {
    std::vector<Eigen::VectorXd> starts;
    for (const double frequency : {-2.5, -1.5, -0.5, 0.5}) {
      Eigen::VectorXd p = start_of(coordinates, baseline.p, 0.3);
      p(baseline.p.size() + 1) = frequency;
      starts.push_back(p);
    }
    return starts;
  }
  if (h.free[0].is_positive) return {start_of(coordinates, baseline.p, 0.5)};
  return {start_of(coordinates, baseline.p, 0.3)};
}

Candidate try_hypothesis(const Study& study, const Hypothesis& h, const Fit& baseline) {
  Candidate best;
  best.id = h.id;
  best.family = h.family;
  best.hypothesis = &h;
  const bool is_sensor = h.family == Family::kSensor;
  const int channels = is_sensor ? static_cast<int>(study.channels().size()) : 1;
  std::vector<double> evidences;
  for (int c = 0; c < channels; ++c) {
    const Coordinates coordinates = study.with(h, is_sensor ? c : -1);
    Fit now = best_fit(study, coordinates, starts_of(study, h, coordinates, baseline));
    evidences.push_back(now.log_evidence);
    if (c > 0 && now.log_evidence <= best.fit.log_evidence) continue;
    best.fit = std::move(now);
    best.channel = is_sensor ? c : -1;
  }
  const double most = *std::max_element(evidences.begin(), evidences.end());
  double sum = 0.0;
  for (const double value : evidences) sum += std::exp(value - most);
  best.log_evidence = most + std::log(sum / channels);
  return best;
}

Candidate try_unknown(const Study& study, const Fit& baseline) {
  Candidate best;
  best.id = "unknown";
  best.family = Family::kUnknown;
  std::vector<double> evidences;
  for (const double spread : kLatentSpreads) {
    const Coordinates coordinates = study.with_latent(kLatentKnots, spread);
    Fit now = fit(study, coordinates, start_of(coordinates, baseline.p, 0.0), 20);
    evidences.push_back(now.log_evidence);
    if (evidences.size() > 1 && now.log_evidence <= best.fit.log_evidence) continue;
    best.fit = std::move(now);
  }
  const double most = *std::max_element(evidences.begin(), evidences.end());
  double sum = 0.0;
  for (const double value : evidences) sum += std::exp(value - most);
  best.log_evidence = most + std::log(sum / static_cast<double>(evidences.size()));
  return best;
}

}  // namespace

void estimate_noise(Study& study) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Index>(study.baseline().size()));
  const Fit baseline = fit(study, study.baseline(), zero, 8);
  const Coordinates coordinates = study.with_latent(kLatentKnots, 0.05);
  const Fit rich = fit(study, coordinates, start_of(coordinates, baseline.p, 0.0), 6);
  for (std::size_t r = 0; r < study.observed().size(); ++r) {
    Observed& o = study.observed()[r];
    const std::size_t n = o.times.size();
    if (n < 32) continue;  // too few for a spectrum; the rough estimate stays
    const std::vector<double> predicted = study.predict(r, coordinates, rich.p);
    for (std::size_t c = 0; c < o.noise.size(); ++c) {
      std::vector<double> rest(n);
      for (std::size_t i = 0; i < n; ++i)
        rest[i] = o.weights[c][i] * (o.samples[c][i] - predicted[c * n + i]);
      o.noise[c] = fit_noise(rest);
      // More noise than twice what the recording says is a misfit in disguise.
      if (o.stated[c] > 0.0) o.noise[c].sd = std::min(o.noise[c].sd, 2.0 * o.stated[c]);
    }
  }
}

std::vector<Candidate> screen(const Study& study) {
  std::vector<Candidate> all;
  Candidate none;
  none.id = "baseline";
  none.fit = fit(study, study.baseline(),
                 Eigen::VectorXd::Zero(static_cast<Index>(study.baseline().size())));
  none.log_evidence = none.fit.log_evidence;
  none.log_prior = std::log(0.5);
  all.push_back(none);
  for (const Hypothesis& h : kHypotheses)
    if (is_open(study, h)) all.push_back(try_hypothesis(study, h, none.fit));
  for (std::size_t k = 1; k < all.size(); ++k)
    all[k].log_prior = std::log(0.45 / static_cast<double>(all.size() - 1));
  all.push_back(try_unknown(study, none.fit));
  all.back().log_prior = std::log(0.05);
  weigh(all, 1.0);
  return all;
}

Candidate combine(const Study& study, const Candidate& a, const Candidate& b) {
  const std::size_t shared = study.baseline().size();
  Candidate both;
  both.id = a.id + "+" + b.id;
  both.family = a.family == Family::kPhysics ? a.family : b.family;
  both.hypothesis = a.hypothesis;
  both.channel = a.channel;
  Coordinates coordinates = a.fit.coordinates;
  // A parameter's own spread wins wherever one of the two widens it.
  for (std::size_t j = 0; j < shared; ++j)
    if (b.fit.coordinates[j].sd > coordinates[j].sd) coordinates[j].sd = b.fit.coordinates[j].sd;
  coordinates.insert(coordinates.end(),
                     b.fit.coordinates.begin() + static_cast<std::ptrdiff_t>(shared),
                     b.fit.coordinates.end());
  Eigen::VectorXd p = Eigen::VectorXd::Zero(static_cast<Index>(coordinates.size()));
  for (std::size_t j = shared; j < a.fit.coordinates.size(); ++j)
    p(static_cast<Index>(j)) = a.fit.p(static_cast<Index>(j));
  for (std::size_t j = shared; j < b.fit.coordinates.size(); ++j)
    p(static_cast<Index>(a.fit.coordinates.size() + j - shared)) = b.fit.p(static_cast<Index>(j));
  both.fit = best_fit(study, coordinates, {p});
  both.log_evidence = both.fit.log_evidence;
  return both;
}

void weigh(std::vector<Candidate>& candidates, double temper) {
  double most = -INFINITY;
  for (const Candidate& c : candidates)
    most = std::max(most, c.log_prior + temper * c.log_evidence);
  double sum = 0.0;
  for (Candidate& c : candidates) {
    c.probability = std::exp(c.log_prior + temper * c.log_evidence - most);
    sum += c.probability;
  }
  for (Candidate& c : candidates) c.probability /= sum;
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.probability > b.probability; });
}

}  // namespace grouser::diagnosis
