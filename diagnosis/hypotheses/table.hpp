// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/added_mass.hpp"
#include "diagnosis/hypotheses/ambient_flow.hpp"
#include "diagnosis/hypotheses/basset.hpp"
#include "diagnosis/hypotheses/clip.hpp"
#include "diagnosis/hypotheses/drag_inertia.hpp"
#include "diagnosis/hypotheses/drift.hpp"
#include "diagnosis/hypotheses/filter.hpp"
#include "diagnosis/hypotheses/gain.hpp"
#include "diagnosis/hypotheses/lag.hpp"
#include "diagnosis/hypotheses/lubrication.hpp"
#include "diagnosis/hypotheses/parameter_diameter.hpp"
#include "diagnosis/hypotheses/parameter_fluid_density.hpp"
#include "diagnosis/hypotheses/parameter_particle_density.hpp"
#include "diagnosis/hypotheses/parameter_restitution.hpp"
#include "diagnosis/hypotheses/parameter_trigger.hpp"
#include "diagnosis/hypotheses/parameter_viscosity.hpp"
#include "diagnosis/hypotheses/release_force.hpp"
#include "diagnosis/hypotheses/side_wall.hpp"
#include "diagnosis/hypotheses/step.hpp"
#include "diagnosis/hypotheses/vibration.hpp"
#include "diagnosis/hypotheses/zero.hpp"

namespace grouser::diagnosis {

/// The catalogue. A new hypothesis is one file and one line here.
inline constexpr std::array<Hypothesis, 21> kHypotheses{{
    kDragInertia,
    kAddedMass,
    kBasset,
    kLubrication,
    kSideWall,
    kAmbientFlow,
    kReleaseForce,
    kVibration,
    kGain,
    kZero,
    kLag,
    kFilter,
    kDrift,
    kClip,
    kStep,
    kParameterDiameter,
    kParameterParticleDensity,
    kParameterFluidDensity,
    kParameterViscosity,
    kParameterRestitution,
    kParameterTrigger,
}};

/// The hypothesis of that id, or nullptr. Local.
const Hypothesis* find_hypothesis(const char* id);

}  // namespace grouser::diagnosis
