// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/sweep_averaged.hpp"

#include "engine/lbm/sweep.hpp"

namespace grouser {
namespace {

using Number = Wide<double>;

// What leaves a cell. Fields are those at place `at`.
template <class Set>
[[gnu::always_inline]] inline void collide(Number* f, const TwoRates<double>& rates,
                                           const Vec3& force, double* const* fields,
                                           std::ptrdiff_t at) {
  using Fields = AveragedFields;
  const auto field = [&](std::size_t which)
                         GROUSER_INLINE { return load_wide(fields[which] + at); };
  NodeMoments<Set, Number> m = moments_of<false, Set>(f, Vec3{});
  const Vec3T<Number> push{field(Fields::kPushX) + force.x, field(Fields::kPushY) + force.y,
                           field(Fields::kPushZ) + force.z};
  const Number drag = field(Fields::kDrag);
  const Number source = field(Fields::kSource);
  // Half of what the step adds is there in its middle (Guo, Zheng, Shi 2002).
  m.excess = m.excess + 0.5 * source;
  m.density = m.excess + 1.0;
  const Vec3T<Number> pushed{m.momentum.x + 0.5 * push.x, m.momentum.y + 0.5 * push.y,
                             m.momentum.z + 0.5 * push.z};
  // density x void fraction x u = pushed - drag/2 x u
  const Number inverse = 1.0 / (m.density * field(Fields::kVoid) + 0.5 * drag);
  m.velocity = inverse * pushed;
  const Vec3T<Number> held{drag * m.velocity.x, drag * m.velocity.y, drag * m.velocity.z};
  m.momentum = {pushed.x - 0.5 * held.x, pushed.y - 0.5 * held.y, pushed.z - 0.5 * held.z};
  const Vec3T<Number> total{push.x - held.x, push.y - held.y, push.z - held.z};
  store_wide(fields[Fields::kVelocityX] + at, m.velocity.x);
  store_wide(fields[Fields::kVelocityY] + at, m.velocity.y);
  store_wide(fields[Fields::kVelocityZ] + at, m.velocity.z);
  store_wide(fields[Fields::kPressure] + at, kSoundSpeed2 * m.excess);
  const Number born = (1.0 - 0.5 * rates.even) * source;
  rates.template relax<Set, true>(f, m, total, [&](auto k) GROUSER_INLINE {
    constexpr std::size_t i = k == Set::kVelocities / 2 ? 0 : 2 * k + 1;
    return Set::kSet.weights[i] * born;
  });
}

template <class Set, Parity kParity>
void sweep_parity(Populations<double>& populations, const TwoRates<double>& rates,
                  const Vec3& force, const SweepRange& range, double* const* fields) {
  const auto nothing = [](const Row&) {};
  walk<Set, double, kParity>(
      populations, range, nothing,
      [&](Number* f, std::ptrdiff_t at, const Row&)
          GROUSER_INLINE { collide<Set>(f, rates, force, fields, at); },
      nothing);
}

}  // namespace

template <class Set>
void sweep_averaged(Streaming<Set, double>& streaming, const TwoRates<double>& collision,
                    const Vec3& force, const SweepRange& range, AveragedFields& fields) {
  double* of[AveragedFields::kFields];
  for (std::size_t k = 0; k < AveragedFields::kFields; ++k)
    of[k] = fields.of(static_cast<AveragedFields::Field>(k));
  Populations<double>& populations = streaming.populations();
  if (streaming.parity() == Parity::kEven)
    sweep_parity<Set, Parity::kEven>(populations, collision, force, range, of);
  else
    sweep_parity<Set, Parity::kOdd>(populations, collision, force, range, of);
}

template void sweep_averaged<D3Q19>(Streaming<D3Q19, double>&, const TwoRates<double>&, const Vec3&,
                                    const SweepRange&, AveragedFields&);

}  // namespace grouser
