// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kParameterFluidDensity{
    "parameter_fluid_density",
    Family::kParameter,
    "Density of the liquid beyond its uncertainty",
    {},
    0,
    Setting::kFluidDensity,
    {"whole fall", "difference of the densities: light spheres most", "sphere density, viscosity",
     "weigh a volume of liquid"}};

}  // namespace grouser::diagnosis
