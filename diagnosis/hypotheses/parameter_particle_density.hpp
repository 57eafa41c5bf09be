// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kParameterParticleDensity{
    "parameter_particle_density",
    Family::kParameter,
    "Density of the sphere beyond its uncertainty",
    {},
    0,
    Setting::kParticleDensity,
    {"whole fall", "difference of the densities", "viscosity, fluid density, gain",
     "weigh the sphere"}};

}  // namespace grouser::diagnosis
