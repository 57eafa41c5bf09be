// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kSideWall{
    "side_wall",
    Family::kPhysics,
    "Side wall of the container",
    {{theory(Setting::kSideWall)}},
    1,
    {},
    {"whole fall; steady speed too low", "diameter over width alone, in creeping flow",
     "viscosity, gain, density", "another container"}};

}  // namespace grouser::diagnosis
