// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/inference/diagnose.hpp"

namespace grouser::diagnosis {

/// Predicts the conditions of `held` with what `candidate` learnt from `fitted`: shared settings
/// and amplitudes keep their posterior as prior, the condition's own unknowns (release, trigger)
/// have theirs afresh, for every candidate alike. @return the fit to the held-out data. Local.
Fit predict_held_out(const Study& fitted, const Candidate& candidate, const Study& held);

/// Errors of one condition of a fit, root mean square over range, mean of the channels.
double relative_error(const Study& study, std::size_t condition, const Fit& fit);

/// What noise alone would leave of such an error. Local.
double noise_error(const Study& study, std::size_t condition);

/// Baseline, cause and placebos on conditions that were not fitted; on each fitted one in turn when
/// the recording keeps none back and has two.
std::vector<HeldOut> prove(const SeriesRecording& recording, const Baseline& baseline,
                           const Study& study, const std::vector<Candidate>& candidates,
                           const Candidate& best);

/// Recorded and predicted curves of all conditions, held-out ones first. `best` may be null. Local.
std::vector<Curves> show(const SeriesRecording& recording, const Baseline& baseline,
                         const Study& study, const Candidate& none, const Candidate* best);

}  // namespace grouser::diagnosis
