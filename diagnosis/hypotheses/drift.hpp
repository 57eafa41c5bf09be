// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kDrift{
    "drift",
    Family::kSensor,
    "Drift of a sensor",
    {{FreeSetting{Setting::kDrift, 0.0, 0.05, Scale::kRate}}},
    1,
    {},
    {"one channel, growing with time, before the release and at rest as well",
     "independent of the motion", "ambient flow, viscosity", "record at rest"}};

}  // namespace grouser::diagnosis
