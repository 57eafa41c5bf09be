// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/lbm/sweep.hpp"
#include "engine/lbm/sweep_immersed.hpp"
#include "engine/lbm/sweep_rows.hpp"

namespace grouser {

template <class Set, class Real>
void sweep_rows(Streaming<Set, Real>& streaming, const Collision<Real>& collision,
                const Vec3& force, const SweepRange& range) {
  const Vec3T<Real> push{static_cast<Real>(force.x), static_cast<Real>(force.y),
                         static_cast<Real>(force.z)};
  const bool forced = !(force == Vec3{});
  const bool even = streaming.parity() == Parity::kEven;
  Populations<Real>& populations = streaming.populations();
  std::visit(
      [&](const auto& law) {
        if (even && forced) sweep<Set, Real, true, Parity::kEven>(populations, law, push, range);
        if (even && !forced) sweep<Set, Real, false, Parity::kEven>(populations, law, push, range);
        if (!even && forced) sweep<Set, Real, true, Parity::kOdd>(populations, law, push, range);
        if (!even && !forced) sweep<Set, Real, false, Parity::kOdd>(populations, law, push, range);
      },
      collision);
}

template <class Set, class Real>
void sweep_immersed_rows(Streaming<Set, Real>& streaming, const Collision<Real>& collision,
                         const Vec3& force, const SweepRange& range, const SolidMap& map,
                         ImmersedRows<Real>& solids) {
  const Vec3T<Real> push{static_cast<Real>(force.x), static_cast<Real>(force.y),
                         static_cast<Real>(force.z)};
  Populations<Real>& populations = streaming.populations();
  std::visit(
      [&](const auto& law) {
        if (streaming.parity() == Parity::kEven)
          sweep_immersed<Set, Real, Parity::kEven>(populations, law, push, range, map, solids);
        else
          sweep_immersed<Set, Real, Parity::kOdd>(populations, law, push, range, map, solids);
      },
      collision);
}

}  // namespace grouser
