// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/models/model.hpp"

namespace grouser::diagnosis {

/// A sphere let go in a liquid above a horizontal floor, moving vertically: weight, buoyancy and
/// Stokes drag always; the rest by amplitude.
///   drag_inertia  1 + 0.15 Re^0.687 (Schiller and Naumann 1933), Re below 800
///   added_mass    half the displaced fluid
///   basset        3/2 d^2 sqrt(pi rho mu) integral of dv/ds / sqrt(t - s) (Basset 1888)
///   lubrication   drag times (7 x + 2)/(6 x^2 + 2 x) on top, x = gap/a: Bevan and Prieve 2000, a
///   fit
///                 to Brenner 1961 that becomes 1/x near the floor; a roughness of a/1000 ends it
///   side_wall     1/(1 - 2.104 x + 2.09 x^3 - 0.95 x^5), x = d/width (Faxen 1922), creeping flow
/// Contact with the floor is instantaneous with a constant restitution. Neglected: rotation and
/// lateral motion, unsteady wakes, interaction of the terms with each other beyond the product of
/// the drag factors.
std::unique_ptr<Model> make_sphere_model(ModelPlan plan);

}  // namespace grouser::diagnosis
