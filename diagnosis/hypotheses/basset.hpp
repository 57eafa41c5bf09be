// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kBasset{
    "basset",
    Family::kPhysics,
    "Basset history force",
    {{theory(Setting::kBasset)}},
    1,
    {},
    {"after every acceleration, with a tail", "fades with the root of time; d^2 sqrt(rho mu)",
     "added mass, release force, temperature", "hold after the release, or two accelerations"}};

}  // namespace grouser::diagnosis
