// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/inference/screen.hpp"
#include "diagnosis/recordings/admission.hpp"

namespace grouser::diagnosis {

enum class Word { kNoMismatch, kNamed, kProvisional, kNoneOfTheKnown };
const char* word_of(Word word);

/// Whether the method's rates were measured on recordings that it was not developed on:
/// docs/diagnosis/blind.md. Without, no verdict would be stronger than provisional.
inline constexpr bool kIsCalibrated = true;

/// How strongly a cause may be named from so many fitted conditions: kNamed by a calibrated method
/// from two or more, else kProvisional. A value beyond its uncertainty is never more than
/// provisional: whatever nobody has listed and changes the drag alike looks like one. Local.
Word strongest_word(std::size_t conditions, Family family, bool is_calibrated = kIsCalibrated);

/// What the baseline has on and how it is run.
struct Baseline {
  std::string model = "sphere_ode";
  Terms terms{};
};

/// Reads a baseline of the ladder's lowest level: `baseline: 1`, `model:`, `terms:` with
/// amplitudes.
/// @throws ConfigError. Local.
Baseline read_baseline(const std::string& file);
/// What a sphere in a liquid has when nobody says otherwise: drag with inertia, nothing else.
Baseline default_baseline();

/// Where a cause acts: one entry per sample of each fitted condition.
struct Location {
  std::string condition;
  std::vector<double> times;
  std::vector<double> size;    ///< of the cause's own force or change of the channel, its peak 1
  std::vector<bool> mask;      ///< size above a quarter of the peak
  std::vector<double> latent;  ///< mean of the unknown force over the buoyant weight
  std::vector<double> latent_error;  ///< its standard deviation
};

/// Prediction of what was not fitted.
struct HeldOut {
  std::string condition;
  double baseline_error = 0.0;   ///< root mean square over the channel's range
  double candidate_error = 0.0;  ///< same with the cause on
  double gain = 0.0;             ///< ln predictive density, candidate minus baseline
  double placebo_gain = 0.0;     ///< the largest gain of any cause outside the set
  double noise = 0.0;            ///< error that noise alone would leave
  std::vector<std::pair<std::string, double>> placebos;  ///< gain of every other cause
};

/// Recorded and predicted samples of one condition, for people to look at.
struct Curves {
  std::string condition;
  bool is_held_out = false;
  std::vector<double> times;
  std::vector<std::vector<double>> recorded;  ///< per channel
  std::vector<std::vector<double>> before;    ///< baseline
  std::vector<std::vector<double>> after;     ///< with the cause; empty without one
  std::vector<double> noise;                  ///< one standard deviation per channel
};

/// One answer.
struct Diagnosis {
  std::string recording;
  Word word = Word::kNoMismatch;
  bool is_calibrated = kIsCalibrated;
  std::string cause;  ///< id, two with `+`, `unknown` or ``
  Family family = Family::kBaseline;
  std::string channel;                  ///< of a sensor's fault
  double probability = 0.0;             ///< of the cause
  std::vector<std::string> set;         ///< smallest with 95 %
  std::vector<std::string> confusable;  ///< within a Bayes factor of 10 of the cause
  Detection detection;                  ///< of the baseline
  Detection check;                      ///< of the cause's own fit
  std::vector<Candidate> candidates;
  double amplitude = 0.0;  ///< of a theory's term; 0 = has none
  double amplitude_error = 0.0;
  double invariance = 1.0;  ///< chance of so different amplitudes in the conditions, by Cochran's Q
  std::vector<double> amplitudes;  ///< of each condition by itself
  std::vector<double> amplitude_errors;
  std::vector<Location> locations;
  std::vector<HeldOut> held_out;
  std::vector<Curves> curves;  ///< held-out conditions first
  std::vector<Finding> findings;
  std::vector<std::string> flags;  ///< what weakens the answer, one sentence each
  std::size_t fitted = 0;          ///< conditions
  long runs = 0;
  double seconds = 0.0;

  const Candidate* best() const;
};

/// The whole chain on one recording. The same input gives the same answer. Local.
Diagnosis diagnose(const SeriesRecording& recording, const Baseline& baseline);

}  // namespace grouser::diagnosis
