// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "diagnosis/inference/detect.hpp"

namespace grouser::diagnosis {

/// One cause with its best fit.
struct Candidate {
  std::string id;  ///< `baseline`, a hypothesis, two with `+`, or `unknown`
  Family family = Family::kBaseline;
  const Hypothesis* hypothesis = nullptr;
  int channel = -1;  ///< of a sensor's fault
  Fit fit;
  double log_evidence = 0.0;  ///< averaged over channels or spreads
  double log_prior = 0.0;
  double probability = 0.0;

  /// Number of the first coordinate that the cause adds; the baseline's come before.
  std::size_t first_own(const Study& study) const { return study.baseline().size(); }
};

/// Noise of every channel from what a fit with a free force leaves, put into the study.
void estimate_noise(Study& study);

/// Fits the baseline, every cause of the catalogue that the baseline lacks, and the unknown force.
/// A term of theory starts at amplitude 1 and the priors' means, never at the calibrated baseline,
/// whose parameters have eaten the misfit. Sorted by evidence and prior. Local.
std::vector<Candidate> screen(const Study& study);

/// Evidence of two causes at once from one linear step beside the fit of `a`: a few runs instead of
/// a fit, good enough to choose which pairs are worth fitting.
double guess_together(const Study& study, const Candidate& a, const Candidate& b);

/// Two causes at once, from their single fits.
Candidate combine(const Study& study, const Candidate& a, const Candidate& b);

/// Sets probabilities: prior times evidence to the power `temper`, together 1.
void weigh(std::vector<Candidate>& candidates, double temper);

inline constexpr int kLatentKnots = 12;

}  // namespace grouser::diagnosis
