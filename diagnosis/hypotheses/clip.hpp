// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kClip{
    "clip",
    Family::kSensor,
    "Clipped sensor",
    {{FreeSetting{Setting::kClip, 0.0, 0.15, Scale::kAbsolute, false, true}}},
    1,
    {},
    {"top of one channel's range", "a fixed limit", "a force that holds the speed",
     "histogram of the values; a smaller signal"}};

}  // namespace grouser::diagnosis
