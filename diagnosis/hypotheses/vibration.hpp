// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kVibration{
    "vibration",
    Family::kImitator,
    "Swinging camera or container",
    {{FreeSetting{Setting::kVibration, 0.0, 0.01, Scale::kRange, false, true},
      FreeSetting{Setting::kVibrationFrequency, 0.2, 1.0, Scale::kInterval, true},
      FreeSetting{Setting::kVibrationPhase, 0.0, 2.0}}},
    3,
    {},
    {"everywhere alike, before the release as well", "one frequency", "an unknown periodic force",
     "record the resting sphere"}};

}  // namespace grouser::diagnosis
