// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kLag{
    "lag",
    Family::kSensor,
    "Lag of a sensor",
    {{FreeSetting{Setting::kLag, 0.0, 8.0, Scale::kInterval, false, true}}},
    1,
    {},
    {"after every change, in one channel", "one time in all phases and runs",
     "added mass, trigger, filter", "a second sensor; kinematic consistency"}};

}  // namespace grouser::diagnosis
