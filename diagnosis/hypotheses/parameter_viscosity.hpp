// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kParameterViscosity{
    "parameter_viscosity",
    Family::kParameter,
    "Viscosity beyond its uncertainty",
    {},
    0,
    Setting::kViscosity,
    {"whole fall", "drag in proportion at low Re, less at high Re", "side wall, drag law, gain",
     "thermometer; terminal speeds at two Reynolds numbers"}};

}  // namespace grouser::diagnosis
