// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/lbm/immersed_rows.hpp"
#include "engine/lbm/streaming.hpp"

namespace grouser {

/// The sweep that is due, with this collision. Compiled apart for each lattice: every one has
/// sweeps of all collisions, with and without force, in both precisions. Local.
template <class Set, class Real>
void sweep_rows(Streaming<Set, Real>& streaming, const Collision<Real>& collision,
                const Vec3& force, const SweepRange& range);

/// The same with solids in the fluid. Not for flat lattices. Local.
template <class Set, class Real>
void sweep_immersed_rows(Streaming<Set, Real>& streaming, const Collision<Real>& collision,
                         const Vec3& force, const SweepRange& range, const SolidMap& map,
                         ImmersedRows<Real>& solids);

}  // namespace grouser
