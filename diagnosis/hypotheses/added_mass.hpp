// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kAddedMass{
    "added_mass",
    Family::kPhysics,
    "Added mass",
    {{theory(Setting::kAddedMass)}},
    1,
    {},
    {"release, bounce, every change of speed",
     "half the displaced fluid times the acceleration; strongest for light spheres",
     "Basset history, release force, lag, trigger", "a light sphere beside a heavy one"}};

}  // namespace grouser::diagnosis
