// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kFilter{
    "filter",
    Family::kSensor,
    "Smoothing of a sensor",
    {{FreeSetting{Setting::kFilter, 0.0, 16.0, Scale::kInterval, false, true}}},
    1,
    {},
    {"both sides of every change, in one channel", "one length in all phases and runs",
     "lubrication, soft contact, lag", "a second sensor; a sharp event"}};

}  // namespace grouser::diagnosis
