// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kGain{
    "gain",
    Family::kSensor,
    "Scale of a sensor",
    {{FreeSetting{Setting::kGain, 0.0, 0.1}}},
    1,
    {},
    {"one channel, in proportion to its value", "no physics: the same share in every run",
     "viscosity, side wall, density", "a second sensor, or a known distance"}};

}  // namespace grouser::diagnosis
