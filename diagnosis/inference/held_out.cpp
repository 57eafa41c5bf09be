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

bool keeps_back(const SeriesRecording& recording) {
  return std::any_of(recording.conditions.begin(), recording.conditions.end(),
                     [](const Condition& c) { return c.is_held_out(); });
}

void compare(const Study& fitted, const Study& held, const std::vector<Candidate>& candidates,
             const Candidate& best, std::vector<HeldOut>& out) {
  const Fit before = predict_held_out(fitted, *find(candidates, "baseline"), held);
  const Fit after = predict_held_out(fitted, best, held);
  HeldOut all;
  for (const Candidate& c : candidates) {
    if (c.id == "baseline" || c.id == "unknown" || best.id.find(c.id) != std::string::npos ||
        c.probability > 0.1 * best.probability || c.id.find('+') != std::string::npos)
      continue;
    const double gain = predict_held_out(fitted, c, held).log_evidence - before.log_evidence;
    all.placebos.emplace_back(c.id, gain);
    all.placebo_gain = std::max(all.placebo_gain, gain);
  }
  all.gain = after.log_evidence - before.log_evidence;
  for (std::size_t r = 0; r < held.observed().size(); ++r) {
    HeldOut h = all;
    h.condition = held.observed()[r].name;
    h.baseline_error = relative_error(held, r, before);
    h.candidate_error = relative_error(held, r, after);
    h.noise = noise_error(held, r);
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
  Eigen::VectorXd start = Eigen::VectorXd::Zero(static_cast<Index>(coordinates.size()));
  const Eigen::VectorXd aligned = held.start(held.baseline());
  for (std::size_t j = 0; j < held.baseline().size(); ++j)
    if (held.baseline()[j].setting == Setting::kTrigger)
      start(static_cast<Index>(j)) = aligned(static_cast<Index>(j));
  return fit(held, coordinates, start, 12);
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

double noise_error(const Study& study, std::size_t condition) {
  const Observed& o = study.observed()[condition];
  double mean = 0.0;
  for (std::size_t c = 0; c < o.samples.size(); ++c) {
    const auto [low, high] = std::minmax_element(o.samples[c].begin(), o.samples[c].end());
    mean += o.noise[c].sd / (*high - *low) / static_cast<double>(o.samples.size());
  }
  return mean;
}

Curves curves_of(const Study& study, std::size_t r, const Fit& before, const Fit* after) {
  const Observed& o = study.observed()[r];
  Curves curves{o.name, false, o.times, o.samples, {}, {}, {}};
  for (const NoiseModel& noise : o.noise) curves.noise.push_back(noise.sd);
  const auto put = [&](const Fit& fit, std::vector<std::vector<double>>& out) {
    const std::vector<double> all = study.predict(r, fit.coordinates, fit.p);
    const auto n = static_cast<std::ptrdiff_t>(o.times.size());
    for (std::ptrdiff_t c = 0; c < static_cast<std::ptrdiff_t>(o.samples.size()); ++c)
      out.emplace_back(all.begin() + c * n, all.begin() + (c + 1) * n);
  };
  put(before, curves.before);
  if (after != nullptr) put(*after, curves.after);
  return curves;
}

std::vector<Curves> show(const SeriesRecording& recording, const Baseline& baseline,
                         const Study& study, const Candidate& none, const Candidate* best) {
  std::vector<Curves> out;
  if (keeps_back(recording)) {
    Study held(recording, baseline.terms, true);
    estimate_noise(held);
    const Fit before = predict_held_out(study, none, held);
    const Fit after = best != nullptr ? predict_held_out(study, *best, held) : Fit{};
    for (std::size_t r = 0; r < held.observed().size(); ++r) {
      out.push_back(curves_of(held, r, before, best != nullptr ? &after : nullptr));
      out.back().is_held_out = true;
    }
  }
  for (std::size_t r = 0; r < study.observed().size(); ++r)
    out.push_back(curves_of(study, r, none.fit, best != nullptr ? &best->fit : nullptr));
  return out;
}

std::vector<HeldOut> prove(const SeriesRecording& recording, const Baseline& baseline,
                           const Study& study, const std::vector<Candidate>& candidates,
                           const Candidate& best) {
  std::vector<HeldOut> out;
  if (keeps_back(recording)) {
    Study held(recording, baseline.terms, true);
    estimate_noise(held);
    compare(study, held, candidates, best, out);
  }
  return out;
}

}  // namespace grouser::diagnosis
