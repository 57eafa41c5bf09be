// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kStep{
    "step",
    Family::kNumerics,
    "Time step of the simulation",
    {{FreeSetting{Setting::kStepFactor, 4.0, 1.0, Scale::kAbsolute, true}}},
    1,
    {},
    {"fast changes", "with the square of the step", "lubrication, contact",
     "simulation only: halve the step"}};

}  // namespace grouser::diagnosis
