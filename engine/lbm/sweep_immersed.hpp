// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/lbm/immersed_rows.hpp"
#include "engine/lbm/sweep.hpp"

namespace grouser {
namespace detail {

/// Replaces what leaves a cell by its mixture with what a solid at velocity `solid` sends back.
/// @param f       what leaves by the plain collision, changed in place
/// @param before  what arrived
/// @param m       its moments
/// Source: Noble, Torczynski 1998, eqs. 13 and 15; their sum over velocities takes no mass and
/// gives the momentum density (solid - fluid).
template <class Set, class Real, class T>
[[gnu::always_inline]] inline void mix_with_solid(T* f, const T* before,
                                                  const NodeMoments<Set, T>& m, const T& weight,
                                                  const Vec3T<T>& solid) {
  const Vec3T<T> sum = solid + m.velocity;
  const Vec3T<T> gap = solid - m.velocity;
  const T level = Real(-1.5) * m.density * dot(gap, sum);
  const auto mix = [&](T& leaves, const T& back)
                       GROUSER_INLINE { leaves = leaves + weight * (back - leaves); };
  unroll<Set::kVelocities / 2>([&](auto k) GROUSER_INLINE {
    constexpr auto w = static_cast<Real>(Set::kSet.weights[2 * k + 1]);
    const T along_sum = along<Set, k>(sum);
    const T along_gap = along<Set, k>(gap);
    const T even =
        Real(0.5) * m.even[k] + w * (level + Real(4.5) * m.density * along_gap * along_sum);
    const T odd = Real(-0.5) * m.odd[k] + (Real(3) * w) * m.density * along_sum;
    mix(f[2 * k + 1], even + odd);
    mix(f[2 * k + 2], even - odd);
  });
  constexpr auto rest = static_cast<Real>(Set::kSet.weights[0]);
  mix(f[0], before[0] + rest * level);
}

}  // namespace detail

/// The sweep of a block with solids in it: as `sweep` where none is, and there to the same bits.
/// Local.
template <class Set, class Real, Parity kParity, class Collide>
void sweep_immersed(Populations<Real>& populations, const Collide& collision,
                    const Vec3T<Real>& force, const SweepRange& range, const SolidMap& map,
                    ImmersedRows<Real>& solids) {
  constexpr auto kLanes = WideOf<Real>::kLanes;
  SolidRow<Real>& solid = solids.row();
  bool has_solids = false;
  walk<Set, Real, kParity>(
      populations, range,
      [&](const Row& row) {
        const std::ptrdiff_t z = row.begin / populations.step_z();
        const std::ptrdiff_t y = (row.begin - z * populations.step_z()) / populations.step_y();
        has_solids = solids.begin_row(y, z, map);
      },
      [&](Wide<Real>* f, std::ptrdiff_t at, const Row& row) GROUSER_INLINE {
        const auto x = static_cast<std::size_t>(at - row.begin);
        if (!has_solids || solid.covered[x / kLanes] == 0) {
          collision.template collide<Set, true>(f, force);
          return;
        }
        Wide<Real> before[Set::kVelocities];
        unroll<Set::kVelocities>([&](auto i) GROUSER_INLINE { before[i] = f[i]; });
        const auto m = moments_of<true, Set>(f, force);
        collision.template collide<Set, true>(f, force);
        detail::mix_with_solid<Set, Real>(
            f, before, m, load_wide(solid.weight.data() + x),
            {load_wide(solid.velocity[0].data() + x), load_wide(solid.velocity[1].data() + x),
             load_wide(solid.velocity[2].data() + x)});
        store_wide(solid.density.data() + x, m.density);
        store_wide(solid.momentum[0].data() + x, m.momentum.x);
        store_wide(solid.momentum[1].data() + x, m.momentum.y);
        store_wide(solid.momentum[2].data() + x, m.momentum.z);
      },
      [&](const Row&) {
        if (has_solids) solids.end_row();
      });
}

}  // namespace grouser
