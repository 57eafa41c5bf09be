// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kZero{
    "zero",
    Family::kSensor,
    "Zero of a sensor",
    {{FreeSetting{Setting::kZero, 0.0, 0.05, Scale::kRange}}},
    1,
    {},
    {"one channel, before the release as well", "the same offset in every run",
     "ambient flow, release gap", "record at rest"}};

}  // namespace grouser::diagnosis
