// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/held_out.hpp"

#include <algorithm>
#include <cmath>

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

/// The coordinate with its posterior as prior.
Coordinate learnt(const Fit& fit, std::size_t j) {
  Coordinate c = fit.coordinates[j];
  const auto at = static_cast<Index>(j);
  c.mean = c.value(fit.p(at));
  c.sd *= std::sqrt(fit.covariance(at, at));
  c.is_positive = false;
  return c;
}

bool is_own(Setting setting) {
  return setting == Setting::kTrigger || setting == Setting::kReleaseGap ||
         setting == Setting::kReleaseSpeed;
}

const Candidate* find(const std::vector<Candidate>& candidates, const std::string& id) {
  for (const Candidate& c : candidates)
    if (c.id == id) return &c;
  return nullptr;
}

void compare(const Study& fitted, const Study& held, const std::vector<Candidate>& candidates,
             const Candidate& best, std::vector<HeldOut>& out) {
  const Candidate& none = *find(candidates, "baseline");
  const Fit before = predict_held_out(fitted, none, held);
  const Fit after = predict_held_out(fitted, best, held);
  double placebo = 0.0;
  for (const Candidate& c : candidates) {
    if (c.id == "baseline" || c.id == "unknown" || best.id.find(c.id) != std::string::npos ||
        c.probability > 0.1 * best.probability)
      continue;
    placebo =
        std::max(placebo, predict_held_out(fitted, c, held).log_evidence - before.log_evidence);
  }
  for (std::size_t r = 0; r < held.observed().size(); ++r) {
    HeldOut h;
    h.condition = held.observed()[r].name;
    h.baseline_error = relative_error(held, r, before);
    h.candidate_error = relative_error(held, r, after);
    h.gain = after.log_evidence - before.log_evidence;
    h.placebo_gain = placebo;
    out.push_back(h);
  }
}

}  // namespace

Fit predict_held_out(const Study& fitted, const Candidate& candidate, const Study& held) {
  std::vector<std::size_t> every(held.observed().size());
  for (std::size_t r = 0; r < every.size(); ++r) every[r] = r;
  Coordinates coordinates = held.baseline();
  const std::size_t shared = fitted.baseline().size();
  for (Coordinate& c : coordinates) {
    if (is_own(c.setting)) continue;
    // A parameter's hypothesis widens its prior here as well as there.
    for (std::size_t j = 0; j < shared; ++j) {
      const Coordinate& known = fitted.baseline()[j];
      if (known.setting != c.setting) continue;
      const double wider = candidate.fit.coordinates[j].sd / known.sd;
      if (known.mean == c.mean && known.sd == c.sd) {
        const std::vector<std::size_t> conditions = c.conditions;
        c = learnt(candidate.fit, j);
        c.conditions = conditions;
        break;
      }
      c.sd *= wider;
    }
  }
  if (candidate.family != Family::kUnknown)
    for (std::size_t j = shared; j < candidate.fit.coordinates.size(); ++j) {
      coordinates.push_back(learnt(candidate.fit, j));
      coordinates.back().conditions = every;
    }
  return fit(held, coordinates, Eigen::VectorXd::Zero(static_cast<Index>(coordinates.size())), 12);
}

double relative_error(const Study& study, std::size_t condition, const Fit& fit) {
  const Observed& o = study.observed()[condition];
  const std::vector<double> predicted = study.predict(condition, fit.coordinates, fit.p);
  const std::size_t n = o.times.size();
  double mean = 0.0;
  for (std::size_t c = 0; c < o.samples.size(); ++c) {
    double square = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      square += std::pow(o.samples[c][i] - predicted[c * n + i], 2);
    const auto [low, high] = std::minmax_element(o.samples[c].begin(), o.samples[c].end());
    mean += std::sqrt(square / static_cast<double>(n)) / (*high - *low) /
            static_cast<double>(o.samples.size());
  }
  return mean;
}

std::vector<HeldOut> prove(const SeriesRecording& recording, const Baseline& baseline,
                           const Study& study, const std::vector<Candidate>& candidates,
                           const Candidate& best) {
  std::vector<HeldOut> out;
  const bool keeps_back = std::any_of(recording.conditions.begin(), recording.conditions.end(),
                                      [](const Condition& c) { return c.is_held_out(); });
  if (keeps_back) {
    Study held(recording, baseline.terms, true);
    estimate_noise(held);
    compare(study, held, candidates, best, out);
  }
  return out;
}

}  // namespace grouser::diagnosis
