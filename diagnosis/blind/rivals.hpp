// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "diagnosis/inference/diagnose.hpp"

namespace grouser::diagnosis {

/// What simpler methods answer to the same recording with the same fits, as a JSON object: name of
/// the method -> id of a cause, `unknown`, or `` for no mismatch.
///   rmse         the fit with the least misfit, whatever it costs in parameters
///   correlation  the cause whose change of the curves is most like the baseline's residual
///   sindy        sparse regression of the acceleration that the baseline lacks, from smoothed and
///                twice differentiated data, on forces (after Brunton, Proctor and Kutz 2016)
///   smc          weighted draws of the baseline's parameters alone, noise enlarged until a fifth
///   of
///                them counts (as GrainLearning does, Cheng et al. 2019): the parameter that moved
///                most, if by two deviations
///   gp           a Gaussian process as discrepancy (Kennedy and O'Hagan 2001): there is one or not
/// The first two call it a mismatch when the baseline's squares are beyond 99 % of chi-squared.
/// Each is the method's idea in its simplest form, not the program of that name. Local.
std::string rivals_of(const SeriesRecording& recording, const Baseline& baseline,
                      const Diagnosis& d);

}  // namespace grouser::diagnosis
