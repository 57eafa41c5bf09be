// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kAmbientFlow{
    "ambient_flow",
    Family::kImitator,
    "Steady flow of the fluid",
    {{FreeSetting{Setting::kAmbientFlow, 0.0, 0.15, Scale::kSpeed}}},
    1,
    {},
    {"whole fall, and a sphere at rest that is pushed", "one speed for all spheres",
     "drift of the gap, viscosity", "two spheres of different speed"}};

}  // namespace grouser::diagnosis
