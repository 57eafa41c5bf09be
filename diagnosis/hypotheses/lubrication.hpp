// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kLubrication{
    "lubrication",
    Family::kPhysics,
    "Lubrication at the floor",
    {{theory(Setting::kLubrication)}},
    1,
    {},
    {"gap below one radius", "radius over gap; rebound fails below a Stokes number of about 10",
     "contact damping, soft contact, low-pass filter",
     "a second liquid or another speed of approach"}};

}  // namespace grouser::diagnosis
