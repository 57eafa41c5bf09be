// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kParameterTrigger{
    "parameter_trigger",
    Family::kParameter,
    "Start of the clock beyond its uncertainty",
    {},
    0,
    Setting::kTrigger,
    {"whole series, as a shift in time", "one time per run", "lag, added mass, release force",
     "record the release itself"}};

}  // namespace grouser::diagnosis
