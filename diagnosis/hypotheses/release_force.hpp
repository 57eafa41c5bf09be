// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kReleaseForce{
    "release_force",
    Family::kImitator,
    "Force at the release that fades",
    {{FreeSetting{Setting::kReleaseForce, 0.0, 0.4},
      FreeSetting{Setting::kReleaseForceTime, 0.1, 1.0, Scale::kDuration, true}}},
    2,
    {},
    {"first part of the fall only", "independent of speed and fluid",
     "Basset history, added mass, trigger",
     "release again in another way, or a second acceleration later"}};

}  // namespace grouser::diagnosis
