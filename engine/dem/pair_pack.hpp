// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/core/pack.hpp"
#include "engine/core/particle.hpp"
#include "engine/dem/history_view.hpp"
#include "engine/dem/pair_slots.hpp"

namespace grouser {

/// Numbers of what a contact does to one of its grains: force and moment, each filled up to four.
inline constexpr std::size_t kGrainLoad = 8;
/// Numbers of a pair's result: what it does to the grain with the lower id, then to the other.
inline constexpr std::size_t kPairResult = 2 * kGrainLoad;

/// A pack of pairs on its way from the grains' positions to their forces.
///
/// The way is cut in two, because it is one long chain of roots and divisions that wait for each
/// other: half as long a chain lets the processor work on more packs at a time.
struct PairPack {
  ContactPointT<Pack> at;
  Pack arm_lower;   ///< from the centre of the grain with the lower id to the contact [m]
  Pack arm_higher;  ///< likewise
  Pack smaller;     ///< of the radii [m]
  PackMask touches;

  /// First half: how the pairs from `slot` on touch and move. @param grains first number of all
  [[gnu::always_inline]] void approach(const double* grains, const PairSlots& slots,
                                       std::size_t slot) {
    const std::uint32_t* const lower = slots.lower_places(slot);
    const std::uint32_t* const higher = slots.higher_places(slot);
    const double* const shape = slots.shapes(slot);
    const auto rows = [grains](const std::uint32_t* places, std::size_t member) {
      return [=](std::size_t k) { return load_quad(grains + places[k] + member); };
    };
    // Differences are formed record by record: half the work of turning both.
    const Vec3T<Pack> apart = columns_of_difference(rows(lower, 0), rows(higher, 0));
    const Pack radius_a = Pack::load(shape);
    const Pack radius_b = Pack::load(shape + Pack::kLanes);
    const Pack reach = radius_a + radius_b;
    const Pack distance2 = norm2(apart);
    // Written so that a NaN counts as a touch and spreads to where it is noticed.
    touches = !(distance2 >= reach * reach);
    const Pack distance = sqrt(distance2);
    at.overlap = reach - distance;
    at.radius = Pack::load(shape + 2 * Pack::kLanes);
    at.mass = Pack::load(shape + 3 * Pack::kLanes);
    // The division need not wait for the root.
    at.normal = (distance * (Pack(1.0) / distance2)) * apart;
    const Vec3T<Pack> velocity =
        columns_of_difference(rows(lower, kVelocityAt), rows(higher, kVelocityAt));
    at.normal_velocity = dot(velocity, at.normal);
    const Pack half = Pack(0.5) * at.overlap;
    arm_lower = radius_a - half;
    arm_higher = radius_b - half;
    const Vec3T<Pack> spin_a = columns_of(rows(lower, kSpinAt));
    const Vec3T<Pack> spin_b = columns_of(rows(higher, kSpinAt));
    at.slip_velocity = velocity - at.normal_velocity * at.normal -
                       cross(arm_lower * spin_a + arm_higher * spin_b, at.normal);
    const Vec3T<Pack> spin = spin_a - spin_b;
    at.rolling_rate = spin - dot(spin, at.normal) * at.normal;
    smaller = select(radius_a < radius_b, radius_a, radius_b);
  }

  /// Second half: renews the histories and leaves what the pairs do to their grains.
  /// @param result kLanes times kPairResult numbers
  template <class Law, class Rolling>
  [[gnu::always_inline]] void act(const Law& law, const Rolling& rolling, double time_step,
                                  double* histories, double* result) const {
    using View = HistoryView<Law, Rolling, Pack>;
    typename View::LawHistory law_history;
    typename View::RollingHistory rolling_history;
    View::load(histories, law_history, rolling_history);
    const ContactForceT<Pack> contact = law.evaluate(at, law_history, time_step);
    const Vec3T<Pack> turning = rolling.evaluate(at, contact, rolling_history, time_step);
    View::store_where(touches, histories, law_history, rolling_history);
    const Vec3T<Pack> twist = cross(contact.tangential, at.normal);
    const Vec3T<Pack> none;
    const Rows force(select(touches, contact.normal * at.normal + contact.tangential, none));
    const Rows moment_lower(select(touches, arm_lower * twist + turning, none));
    const Rows moment_higher(select(touches, arm_higher * twist - turning, none));
    force.store(moment_lower, result, kPairResult);
    (-force).store(moment_higher, result + kGrainLoad, kPairResult);
  }
};

}  // namespace grouser
