// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/diagnose.hpp"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "base/units.hpp"
#include "diagnosis/inference/held_out.hpp"

namespace grouser::diagnosis {
namespace {

using Eigen::Index;

constexpr double kLevel = 0.01;       // of the baseline's detection
constexpr double kCheckLevel = 2e-3;  // below, a cause does not explain all
/// ln of the odds to the unknown force that a pair needs: many pairs are tried, and two curves
/// together bend almost anywhere.
const double kPairOdds = std::log(1000.0);
const double kPairOverSingle = std::log(20.0);  // the same to the best single cause
constexpr double kDoubt = 0.2;          // of the check, below which a second cause is looked for
const double kProven = std::log(10.0);  // the same, that a named cause must gain
constexpr double kRefuted = 8.0;        // ln of the predictive density that held-out data may cost
constexpr double kRemainder = 0.01;  // of the misfit, that a cause may leave when nothing is better
constexpr double kRival = 0.01;      // odds to the best from which on another cause is a rival
constexpr double kTemper = 1.0;      // power of the evidence; 1 as no calibration says otherwise
constexpr int kDraws = 2000;
constexpr std::size_t kPairSeeds = 6;  // best single causes that are tried with every other
constexpr std::size_t kPairFits = 8;   // pairs that are fitted

/// Smallest set with 95 %, the most probable first.
std::vector<std::string> set_of(const std::vector<Candidate>& candidates) {
  std::vector<std::string> set;
  double sum = 0.0;
  for (const Candidate& c : candidates) {
    if (sum >= 0.95) break;
    set.push_back(c.id);
    sum += c.probability;
  }
  return set;
}

bool is_single(const Candidate& c) {
  return c.family != Family::kBaseline && c.family != Family::kUnknown;
}

/// Adds pairs of the best single causes with any other: all are guessed, the likeliest fitted.
void add_pairs(const Study& study, std::vector<Candidate>& candidates) {
  std::vector<Candidate> singles;
  for (const Candidate& c : candidates)
    if (is_single(c)) singles.push_back(c);
  struct Guess {
    double evidence;
    std::size_t a, b;
  };
  std::vector<Guess> guesses;
  for (std::size_t a = 0; a < std::min(kPairSeeds, singles.size()); ++a)
    for (std::size_t b = a + 1; b < singles.size(); ++b)
      guesses.push_back({guess_together(study, singles[a], singles[b]), a, b});
  std::sort(guesses.begin(), guesses.end(),
            [](const Guess& x, const Guess& y) { return x.evidence > y.evidence; });
  const double log_prior = singles[0].log_prior - std::log(static_cast<double>(guesses.size()));
  guesses.resize(std::min(kPairFits, guesses.size()));
  for (const Guess& guess : guesses) {
    Candidate pair = combine(study, singles[guess.a], singles[guess.b]);
    pair.log_prior = log_prior;
    candidates.push_back(std::move(pair));
  }
  weigh(candidates, kTemper);
}

/// How large the cause is at every sample: its force, or what it changes of its channel.
std::vector<double> size_of(const Study& study, const Candidate& c, std::size_t r) {
  const std::size_t n = study.observed()[r].times.size();
  const Settings settings = study.settings_of(r, c.fit.coordinates, c.fit.p);
  const Setting setting =
      c.family == Family::kParameter ? c.hypothesis->widened : c.hypothesis->free[0].setting;
  std::vector<double> size;
  if (c.family != Family::kSensor && setting != Setting::kVibration) {
    size = study.observed()[r].model->force_of(setting, settings);
  } else {
    const Settings off = [&] {
      Settings s = settings;
      s[Setting::kVibration] = 0.0;
      for (SettingValues& sensor : s.sensors) sensor = default_values();
      return s;
    }();
    const std::vector<double> with = study.observed()[r].model->run(settings, {});
    const std::vector<double> without = study.observed()[r].model->run(off, {});
    const std::size_t from = n * static_cast<std::size_t>(std::max(0, c.channel));
    for (std::size_t i = 0; i < n; ++i) size.push_back(with[from + i] - without[from + i]);
  }
  for (double& value : size) value = std::abs(value);
  return size;
}

/// The unknown force of one condition at its samples, with its standard deviation.
void add_latent(const Study& study, const Candidate& unknown, std::size_t r, Location& at) {
  std::vector<std::size_t> knots;
  for (std::size_t j = 0; j < unknown.fit.coordinates.size(); ++j)
    if (unknown.fit.coordinates[j].knot >= 0 && unknown.fit.coordinates[j].conditions[0] == r)
      knots.push_back(j);
  const double step = study.duration_of(r) / static_cast<double>(knots.size() - 1);
  for (const double time : at.times) {
    const double x = (time - study.observed()[r].release) / step;
    double mean = 0.0;
    double error = 0.0;
    if (x >= 0.0 && x <= static_cast<double>(knots.size() - 1)) {
      const auto k = std::min(knots.size() - 2, static_cast<std::size_t>(x));
      const double part = x - static_cast<double>(k);
      mean = (1.0 - part) * unknown.fit.value(knots[k]) + part * unknown.fit.value(knots[k + 1]);
      error = std::max(unknown.fit.deviation(knots[k]), unknown.fit.deviation(knots[k + 1]));
    }
    at.latent.push_back(mean);
    at.latent_error.push_back(error);
  }
}

void locate(const Study& study, Diagnosis& d, const Candidate* best) {
  const auto unknown = std::find_if(d.candidates.begin(), d.candidates.end(),
                                    [](const Candidate& c) { return c.id == "unknown"; });
  for (std::size_t r = 0; r < study.observed().size(); ++r) {
    Location at;
    at.condition = study.observed()[r].name;
    at.times = study.observed()[r].times;
    add_latent(study, *unknown, r, at);
    if (best != nullptr && best->hypothesis != nullptr) {
      at.size = size_of(study, *best, r);
    } else {
      for (std::size_t i = 0; i < at.times.size(); ++i)
        at.size.push_back(std::abs(at.latent[i]) > 2.0 * at.latent_error[i] ? std::abs(at.latent[i])
                                                                            : 0.0);
    }
    const double peak = *std::max_element(at.size.begin(), at.size.end());
    for (double& value : at.size) value = peak > 0.0 ? value / peak : 0.0;
    for (const double value : at.size) at.mask.push_back(value > 0.25);
    d.locations.push_back(std::move(at));
  }
}

/// Amplitude of a theory's term, and of each condition by itself with the shared settings kept.
void check_amplitude(const SeriesRecording& recording, const Baseline& baseline, const Study& study,
                     const Candidate& best, Diagnosis& d) {
  if (best.hypothesis == nullptr || !best.hypothesis->has_theory()) return;
  const std::size_t own = best.first_own(study);
  d.amplitude = best.fit.value(own);
  d.amplitude_error = best.fit.deviation(own);
  if (study.observed().size() < 2 || best.id.find('+') != std::string::npos) return;
  double weights = 0.0;
  double mean = 0.0;
  for (std::size_t r = 0; r < study.observed().size(); ++r) {
    SeriesRecording alone = recording;
    for (Condition& c : alone.conditions)
      c.split = c.name == study.observed()[r].name ? "fit" : "held_out";
    Study one(alone, baseline.terms);
    one.observed()[0].noise = study.observed()[r].noise;
    Coordinates coordinates = one.with(*best.hypothesis, -1);
    // The amplitude is asked of the data, not of the prior.
    coordinates.back().sd *= 4.0;
    const Fit now = fit(one, coordinates, one.start(coordinates), 12);
    d.amplitudes.push_back(now.value(coordinates.size() - 1));
    d.amplitude_errors.push_back(now.deviation(coordinates.size() - 1));
    const double weight = 1.0 / std::pow(d.amplitude_errors.back(), 2);
    weights += weight;
    mean += weight * d.amplitudes.back();
  }
  mean /= weights;
  double q = 0.0;
  for (std::size_t r = 0; r < d.amplitudes.size(); ++r)
    q += std::pow((d.amplitudes[r] - mean) / d.amplitude_errors[r], 2);
  const boost::math::chi_squared chi(static_cast<double>(d.amplitudes.size() - 1));
  d.invariance = boost::math::cdf(boost::math::complement(chi, q));
  if (d.invariance < 0.01)
    d.flags.push_back("its amplitude differs between the conditions beyond chance");
}

/// Whether a theory's term fits only with an amplitude that is not the theory's.
bool has_wrong_size(const Study& study, const Candidate& c) {
  if (c.hypothesis == nullptr || !c.hypothesis->has_theory()) return false;
  const std::size_t own = c.first_own(study);
  return c.fit.value(own) + 2.0 * c.fit.deviation(own) < 0.4 ||
         c.fit.value(own) - 2.0 * c.fit.deviation(own) > 2.5;
}

/// Part of the baseline's misfit that a cause leaves, beyond what noise makes.
double remainder(const Study& study, const Fit& baseline, const Fit& fit) {
  const auto noise = static_cast<double>(study.rows());
  const double before = baseline.residual.squaredNorm() + baseline.p.squaredNorm() - noise;
  const double after = fit.residual.squaredNorm() + fit.p.squaredNorm() - noise;
  return before > 0.0 ? std::max(0.0, after) / before : 1.0;
}

/// ln odds of the best candidate to the unknown force.
double beats_unknown(const std::vector<Candidate>& candidates) {
  for (const Candidate& c : candidates)
    if (c.family == Family::kUnknown)
      return candidates[0].log_prior + candidates[0].log_evidence - c.log_prior - c.log_evidence;
  return INFINITY;
}

/// Whether the best candidate is a cause that leaves nothing that noise would not.
bool is_enough(const Study& study, Diagnosis& d) {
  if (d.candidates[0].family == Family::kUnknown) return false;
  d.check = detect(study, d.candidates[0].fit, kDraws, 2);
  return !d.check.is_mismatch(kCheckLevel);
}

void say_unknown(Diagnosis& d) {
  d.word = Word::kNoneOfTheKnown;
  d.cause = "unknown";
  d.family = Family::kUnknown;
}

/// Tries pairs. @return whether one is so much better than what was there that it is the answer's
/// first candidate now; else the candidates are as before.
bool is_pair_better(const Study& study, Diagnosis& d) {
  const std::vector<Candidate> before = d.candidates;
  const std::string single = before[0].id;
  add_pairs(study, d.candidates);
  const double odds = std::log(d.candidates[0].probability) - std::log([&] {
                        for (const Candidate& c : d.candidates)
                          if (c.id == single) return std::max(1e-300, c.probability);
                        return 1e-300;
                      }());
  if (d.candidates[0].id.find('+') != std::string::npos && odds > kPairOverSingle &&
      beats_unknown(d.candidates) > kPairOdds && is_enough(study, d))
    return true;
  d.candidates = before;
  return false;
}

/// Whether the single best leaves so little, of so much, that its own theory may be that wrong.
bool is_nearly_enough(const Study& study, Diagnosis& d) {
  if (!is_single(d.candidates[0])) return false;
  const auto none = std::find_if(d.candidates.begin(), d.candidates.end(),
                                 [](const Candidate& c) { return c.id == "baseline"; });
  const double left = remainder(study, none->fit, d.candidates[0].fit);
  if (left > kRemainder) return false;
  d.flags.push_back("it leaves " + rounded(100.0 * left) +
                    " % of the misfit, more than noise does");
  return true;
}

/// The answer from weighed candidates; tries pairs when one cause is hardly enough.
void decide(const Study& study, Diagnosis& d) {
  d.word = Word::kNoMismatch;
  if (!d.detection.is_mismatch(kLevel) || d.candidates[0].family == Family::kBaseline) return;
  const bool is_one_enough = is_enough(study, d);
  const Detection check = d.check;
  if ((!is_one_enough || check.p < kDoubt) && !is_pair_better(study, d)) {
    d.check = check;
    if (!is_one_enough && !is_nearly_enough(study, d)) return say_unknown(d);
  }
  if (has_wrong_size(study, d.candidates[0])) {
    d.flags.push_back("it acts like " + d.candidates[0].id +
                      " but not with its size: the amplitude is " +
                      rounded(d.candidates[0].fit.value(d.candidates[0].first_own(study))) +
                      " where theory has 1");
    return say_unknown(d);
  }
  d.cause = d.candidates[0].id;
  d.family = d.candidates[0].family;
  d.word = strongest_word(study.observed().size(), d.family);
}

/// What was held out may refute the cause, never elect one: a cause that predicts it worse than the
/// baseline does gives way to the next that explains as much and predicts it better; without one it
/// is provisional.
void ask_held_out(const SeriesRecording& recording, const Baseline& baseline, const Study& study,
                  Diagnosis& d) {
  const double odds = d.candidates[0].probability;
  std::vector<std::string> refuted;
  double refuting = 0.0;
  for (const Candidate& c : std::vector<Candidate>(d.candidates)) {
    if (c.probability < kRival * odds) break;
    if (!is_single(c) && c.id != d.cause) continue;
    std::vector<HeldOut> held = prove(recording, baseline, study, d.candidates, c);
    const double gain = held.empty() ? 0.0 : held[0].gain;
    if (!refuted.empty() && gain < refuting + kRefuted) continue;
    if (gain < -kRefuted) {
      refuted.push_back(c.id);
      refuting = gain;
      continue;
    }
    if (refuted.empty()) {
      d.held_out = std::move(held);
      if (!d.held_out.empty() && gain < std::max(kProven, d.held_out[0].placebo_gain)) {
        d.word = Word::kProvisional;
        d.flags.push_back("what was held out does not show it better than any other cause");
      }
      return;
    }
    if (detect(study, c.fit, kDraws, 2).is_mismatch(kCheckLevel)) continue;
    d.flags.push_back(refuted[0] +
                      " fits as well but predicts the held-out worse than the baseline");
    d.cause = c.id;
    d.family = c.family;
    d.word = strongest_word(study.observed().size(), d.family);
    d.held_out = std::move(held);
    std::stable_sort(
        d.candidates.begin(), d.candidates.end(),
        [&](const Candidate& a, const Candidate& b) { return (a.id == c.id) > (b.id == c.id); });
    return;
  }
  // No rival is better: the cause stays, and is no more than provisional.
  d.word = Word::kProvisional;
  d.held_out = prove(recording, baseline, study, d.candidates, d.candidates[0]);
  d.flags.push_back("it predicts the held-out worse than the baseline does");
}

/// What makes any answer weaker, whatever it is.
void warn_of_data(const SeriesRecording& recording, const Study& study, Diagnosis& d) {
  if (d.fitted == 1)
    d.flags.push_back("one fitted recording: what it cannot tell apart, nobody can by it");
  for (std::size_t c = 0; c < recording.channels.size(); ++c)
    for (const Observed& o : study.observed()) {
      if (o.times.size() >= 32 || recording.channels[c].noise_sd > 0.0) continue;
      d.flags.push_back(o.name + " has " + std::to_string(o.times.size()) +
                        " samples and no stated noise, which is guessed");
      if (d.word == Word::kNamed) d.word = Word::kProvisional;
    }
  for (const Finding& finding : d.findings)
    if (finding.is_fault)
      d.flags.push_back("the data say of " + finding.channel + " in " + finding.condition + ": " +
                        finding.kind);
}

void describe_cause(const SeriesRecording& recording, const Study& study, Diagnosis& d) {
  d.set = set_of(d.candidates);
  const Candidate& best = d.candidates[0];
  d.probability = d.word == Word::kNoneOfTheKnown ? 0.0 : best.probability;
  if (best.channel >= 0) d.channel = recording.channels[std::size_t(best.channel)].name;
  for (const Candidate& c : d.candidates)
    if (c.probability > 0.1 * best.probability) d.confusable.push_back(c.id);
  if (d.word == Word::kNoneOfTheKnown) d.set = {"unknown"};
  for (std::size_t j = 0; j < study.baseline().size(); ++j) {
    const double p = best.fit.p(static_cast<Index>(j));
    if (std::abs(p) > 2.0 && best.family != Family::kParameter)
      d.flags.push_back(study.baseline()[j].label + " is pushed by " +
                        std::to_string(p).substr(0, 4) + " standard deviations");
  }
}

}  // namespace

const char* word_of(Word word) {
  switch (word) {
    case Word::kNoMismatch:
      return "no_mismatch";
    case Word::kNamed:
      return "named";
    case Word::kProvisional:
      return "provisional";
    case Word::kNoneOfTheKnown:
      return "none_of_the_known";
  }
  return "no_mismatch";
}

Word strongest_word(std::size_t conditions, Family family, bool is_calibrated) {
  const bool is_strong = is_calibrated && conditions > 1 && family != Family::kParameter;
  return is_strong ? Word::kNamed : Word::kProvisional;
}

const Candidate* Diagnosis::best() const {
  for (const Candidate& c : candidates)
    if (c.id == cause) return &c;
  return nullptr;
}

Diagnosis diagnose(const SeriesRecording& recording, const Baseline& baseline) {
  const auto start = std::chrono::steady_clock::now();
  Diagnosis d;
  d.recording = recording.name;
  d.findings = admit(recording);
  Study study(recording, baseline.terms);
  d.fitted = study.observed().size();
  estimate_noise(study);
  d.candidates = screen(study);
  weigh(d.candidates, kTemper);
  const auto none = std::find_if(d.candidates.begin(), d.candidates.end(),
                                 [](const Candidate& c) { return c.id == "baseline"; });
  d.detection = detect(study, none->fit, kDraws, 1);
  decide(study, d);
  if (d.word == Word::kNamed || d.word == Word::kProvisional)
    ask_held_out(recording, baseline, study, d);
  describe_cause(recording, study, d);
  warn_of_data(recording, study, d);
  const Candidate* const best = d.word == Word::kNoneOfTheKnown ? nullptr : d.best();
  if (d.word != Word::kNoMismatch) locate(study, d, best);
  if (best != nullptr) {
    check_amplitude(recording, baseline, study, *best, d);
  }
  const auto baseline_now = std::find_if(d.candidates.begin(), d.candidates.end(),
                                         [](const Candidate& c) { return c.id == "baseline"; });
  d.curves = show(recording, baseline, study, *baseline_now, best);
  d.runs = study.runs();
  d.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return d;
}

}  // namespace grouser::diagnosis
