// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kParameterDiameter{
    "parameter_diameter",
    Family::kParameter,
    "Diameter beyond its uncertainty",
    {},
    0,
    Setting::kDiameter,
    {"whole fall", "weight with d^3, drag with d", "viscosity, density", "measure the sphere"}};

}  // namespace grouser::diagnosis
