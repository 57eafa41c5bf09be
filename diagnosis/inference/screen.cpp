// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/screen.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/hypotheses/table.hpp"

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

constexpr double kLeastNoise = 1e-4;  // of the range
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

/// A sine in the gap.
struct Swing {
  double power = 0.0;
  double amplitude = 0.0;  // [m]
  double frequency = 0.0;
  double phase = 0.0;
};

/// The sine of one frequency that takes most of the residuals of all conditions; the swing of a
/// camera does not know when a sphere is let go.
Swing swing_at(const Study& study, double frequency,
               const std::vector<std::vector<double>>& predicted) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  const double omega = 2.0 * std::numbers::pi * frequency;
  for (std::size_t r = 0; r < study.observed().size(); ++r) {
    const Observed& o = study.observed()[r];
    const std::size_t n = o.times.size();
    for (std::size_t c = 0; c < study.channels().size(); ++c)
      for (std::size_t i = 0; i < n; ++i) {
        const double weight = o.weights[c][i] / o.noise[c].sd;
        const double sine = std::sin(omega * o.times[i]);
        const double cosine = std::cos(omega * o.times[i]);
        const double sign = study.channels()[c] == Signal::kSettlingSpeed ? -omega : omega;
        const Eigen::Vector2d row = weight * (study.channels()[c] == Signal::kGap
                                                  ? Eigen::Vector2d(sine, cosine)
                                                  : Eigen::Vector2d(sign * cosine, -sign * sine));
        normal += row * row.transpose();
        right += row * (weight * (o.samples[c][i] - predicted[r][c * n + i]));
      }
  }
  const Eigen::Vector2d fit = normal.ldlt().solve(right);
  return {right.dot(fit), fit.norm(), frequency, std::atan2(fit(1), fit(0))};
}

/// The two strongest swings in what the baseline leaves, between two periods in the longest
/// condition and a quarter of the sampling frequency.
std::vector<Swing> swings_of(const Study& study, const Fit& baseline) {
  std::vector<std::vector<double>> predicted;
  double longest = 0.0;
  for (std::size_t r = 0; r < study.observed().size(); ++r) {
    predicted.push_back(study.predict(r, baseline.coordinates, baseline.p));
    longest = std::max(longest, study.observed()[r].times.back() - study.observed()[r].times[0]);
  }
  const double highest = 0.25 / study.scale_of(Scale::kInterval, 0);
  std::vector<Swing> all;
  for (double f = 2.0 / longest; f < highest; f += 0.25 / longest)
    all.push_back(swing_at(study, f, predicted));
  if (all.empty()) all.push_back(swing_at(study, highest, predicted));
  std::sort(all.begin(), all.end(),
            [](const Swing& a, const Swing& b) { return a.power > b.power; });
  std::vector<Swing> best{all[0]};
  for (const Swing& swing : all)
    if (best.size() < 2 && std::abs(swing.frequency - best[0].frequency) > 1.5 / longest)
      best.push_back(swing);
  return best;
}

/// @param own number of the first of the three coordinates of a swing
void put_swing(const Swing& swing, const Coordinates& coordinates, std::size_t own,
               Eigen::VectorXd& p) {
  const Coordinate& frequency = coordinates[own + 1];
  const auto at = static_cast<Index>(own);
  p(at) = swing.amplitude / coordinates[own].sd;
  p(at + 1) = std::log(swing.frequency / frequency.mean) / frequency.sd;
  p(at + 2) = swing.phase / coordinates[own + 2].sd;
}

std::vector<Eigen::VectorXd> starts_of(const Study& study, const Hypothesis& h,
                                       const Coordinates& coordinates, const Fit& baseline) {
  if (h.has_theory()) {
    return {study.start(coordinates), start_of(coordinates, baseline.p, 0.0)};
  }
  if (h.family == Family::kParameter) {
    // The same values, counted in wider priors.
    Eigen::VectorXd p = baseline.p;
    for (std::size_t j = 0; j < coordinates.size(); ++j)
      p(static_cast<Index>(j)) *= study.baseline()[j].sd / coordinates[j].sd;
    return {p, study.start(coordinates)};
  }
  if (h.free[0].setting == Setting::kVibration) {
    std::vector<Eigen::VectorXd> starts;
    for (const Swing& swing : swings_of(study, baseline)) {
      starts.push_back(start_of(coordinates, baseline.p, 0.0));
      put_swing(swing, coordinates, static_cast<std::size_t>(baseline.p.size()), starts.back());
    }
    return starts;
  }
  const Eigen::VectorXd means = study.start(study.baseline());
  const double own = h.free[0].is_positive ? 0.5 : 0.3;
  return {start_of(coordinates, baseline.p, own), start_of(coordinates, means, own)};
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
  const Fit baseline = fit(study, study.baseline(), study.start(study.baseline()), 8);
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
      // Nobody's model is better than this, nor is a series without any noise a measured one.
      const auto [low, high] = std::minmax_element(o.samples[c].begin(), o.samples[c].end());
      o.noise[c].sd = std::max(o.noise[c].sd, kLeastNoise * (*high - *low));
      // More noise than four times what the recording says is a misfit in disguise.
      if (o.stated[c] > 0.0) o.noise[c].sd = std::min(o.noise[c].sd, 4.0 * o.stated[c]);
    }
  }
}

namespace {

/// The candidate's own values with the shared ones of another, counted in its own priors.
Eigen::VectorXd borrowed(const Candidate& own, const Candidate& other, std::size_t shared) {
  Eigen::VectorXd p = own.fit.p;
  for (std::size_t j = 0; j < shared; ++j) {
    const auto at = static_cast<Index>(j);
    p(at) = other.fit.p(at) * other.fit.coordinates[j].sd / own.fit.coordinates[j].sd;
  }
  return p;
}

/// Curves with jumps have several maxima. Whoever has found a better one lends its shared settings
/// to the others, which are fitted anew where a linear guess says that it pays.
void share_maxima(const Study& study, std::vector<Candidate>& all) {
  std::vector<Candidate> lenders = all;
  std::sort(lenders.begin(), lenders.end(), [](const Candidate& a, const Candidate& b) {
    return a.fit.log_likelihood > b.fit.log_likelihood;
  });
  lenders.resize(std::min<std::size_t>(4, lenders.size()));
  for (Candidate& c : all)
    for (const Candidate& lender : lenders) {
      if (lender.id == c.id || c.family == Family::kUnknown) continue;
      const Eigen::VectorXd start = borrowed(c, lender, study.baseline().size());
      if (guess_evidence(study, c.fit.coordinates, start) < c.fit.log_evidence + 0.5) continue;
      Fit now = fit(study, c.fit.coordinates, start, 20);
      if (now.log_evidence <= c.fit.log_evidence) continue;
      c.log_evidence += now.log_evidence - c.fit.log_evidence;
      c.fit = std::move(now);
    }
}

}  // namespace

std::vector<Candidate> screen(const Study& study) {
  std::vector<Candidate> all;
  Candidate none;
  none.id = "baseline";
  none.fit = fit(study, study.baseline(), study.start(study.baseline()));
  none.log_evidence = none.fit.log_evidence;
  none.log_prior = std::log(0.5);
  all.push_back(none);
  for (const Hypothesis& h : kHypotheses)
    if (is_open(study, h)) all.push_back(try_hypothesis(study, h, none.fit));
  for (std::size_t k = 1; k < all.size(); ++k)
    all[k].log_prior = std::log(0.45 / static_cast<double>(all.size() - 1));
  all.push_back(try_unknown(study, none.fit));
  all.back().log_prior = std::log(0.05);
  if (study.has_impacts())
    for (int round = 0; round < 2; ++round) share_maxima(study, all);
  weigh(all, 1.0);
  return all;
}

namespace {

Coordinates joined(const Study& study, const Candidate& a, const Candidate& b) {
  const std::size_t shared = study.baseline().size();
  Coordinates coordinates = a.fit.coordinates;
  // A parameter's own spread wins wherever one of the two widens it.
  for (std::size_t j = 0; j < shared; ++j)
    if (b.fit.coordinates[j].sd > coordinates[j].sd) coordinates[j].sd = b.fit.coordinates[j].sd;
  coordinates.insert(coordinates.end(),
                     b.fit.coordinates.begin() + static_cast<std::ptrdiff_t>(shared),
                     b.fit.coordinates.end());
  return coordinates;
}

/// Own coordinates as in the single fits; shared ones as fitted with `a`, or at the priors' means.
Eigen::VectorXd joined_start(const Study& study, const Candidate& a, const Candidate& b,
                             const Coordinates& coordinates, bool is_from_a) {
  const std::size_t shared = study.baseline().size();
  Eigen::VectorXd p = study.start(coordinates);
  for (std::size_t j = 0; j < a.fit.coordinates.size(); ++j)
    if (j >= shared || is_from_a)
      p(static_cast<Index>(j)) =
          a.fit.p(static_cast<Index>(j)) * a.fit.coordinates[j].sd / coordinates[j].sd;
  const bool is_theory = b.hypothesis != nullptr && b.hypothesis->has_theory();
  for (std::size_t j = shared; j < b.fit.coordinates.size(); ++j)
    p(static_cast<Index>(a.fit.coordinates.size() + j - shared)) =
        is_theory && is_from_a ? 0.0 : b.fit.p(static_cast<Index>(j));
  return p;
}

}  // namespace

namespace {

bool is_swing(const Candidate& c) {
  return c.hypothesis != nullptr && c.hypothesis->free[0].setting == Setting::kVibration;
}

/// A swing beside another cause is what that one leaves, not what the baseline left.
Candidate tuned(const Study& study, const Candidate& other, Candidate swing) {
  put_swing(swings_of(study, other.fit)[0], swing.fit.coordinates, swing.first_own(study),
            swing.fit.p);
  return swing;
}

}  // namespace

double guess_together(const Study& study, const Candidate& first, const Candidate& second) {
  const Candidate& a = is_swing(first) ? second : first;
  const Candidate b = is_swing(first)    ? tuned(study, second, first)
                      : is_swing(second) ? tuned(study, first, second)
                                         : second;
  const Coordinates coordinates = joined(study, a, b);
  return std::max(
      guess_evidence(study, coordinates, joined_start(study, a, b, coordinates, true)),
      guess_evidence(study, coordinates, joined_start(study, a, b, coordinates, false)));
}

Candidate combine(const Study& study, const Candidate& first, const Candidate& second) {
  const Candidate& a = is_swing(first) ? second : first;
  const Candidate b = is_swing(first)    ? tuned(study, second, first)
                      : is_swing(second) ? tuned(study, first, second)
                                         : second;
  Candidate both;
  both.id = a.id + "+" + b.id;
  both.family = a.family == Family::kPhysics ? a.family : b.family;
  both.hypothesis = a.hypothesis;
  both.channel = a.channel;
  const Coordinates coordinates = joined(study, a, b);
  both.fit = best_fit(study, coordinates,
                      {joined_start(study, a, b, coordinates, false),
                       joined_start(study, a, b, coordinates, true)});
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
