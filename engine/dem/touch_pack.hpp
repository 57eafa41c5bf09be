// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "engine/core/pack.hpp"
#include "engine/core/particle.hpp"
#include "engine/dem/body.hpp"
#include "engine/dem/history_view.hpp"
#include "engine/dem/pair_pack.hpp"

namespace grouser {

/// Touches of grains with one body that are evaluated together.
template <class Law, class Rolling>
struct TouchPack {
  using View = HistoryView<Law, Rolling, Pack>;
  static constexpr std::size_t kLanes = Pack::kLanes;

  const double* grain[kLanes];    ///< first number of each touch's grain
  const double* nearest[kLanes];  ///< the body's point nearest to its centre [m] and how far [m]
  alignas(Pack::kAlignment) double histories[std::max<std::size_t>(View::kWidth, 1) * kLanes];

  // Results.
  alignas(Pack::kAlignment) double force_moment_y[kLanes];  ///< of the force on the grain [N m]
  alignas(Pack::kAlignment) double couple_y[kLanes];        ///< on the grain, by rolling [N m]
  Pack share;                                               ///< overlap over the grain's radius

  void set_history(std::size_t lane, const double* values) {
    for (std::size_t k = 0; k < View::kWidth; ++k) histories[k * kLanes + lane] = values[k];
  }
  void get_history(std::size_t lane, double* values) const {
    for (std::size_t k = 0; k < View::kWidth; ++k) values[k] = histories[k * kLanes + lane];
  }

  /// Renews the histories and leaves what the touches do to their grains.
  /// @param pushes kLanes times kGrainLoad numbers
  void act(const Law& law, const Rolling& rolling, const BodyMotion& body, double time_step,
           double* pushes) {
    const auto grains = [this](std::size_t member) {
      return [=, this](std::size_t k) { return load_quad(grain[k] + member); };
    };
    const auto all = [](const Vec3& v) { return Vec3T<Pack>{v.x, v.y, v.z}; };
    Pack radius, mass, distance;
    const Vec3T<Pack> position = columns_of(grains(0), &radius);
    const Vec3T<Pack> grain_velocity = columns_of(grains(kVelocityAt), &mass);
    const Vec3T<Pack> grain_spin = columns_of(grains(kSpinAt));
    const Vec3T<Pack> point =
        columns_of([this](std::size_t k) { return load_quad(nearest[k]); }, &distance);
    const Vec3T<Pack> body_spin = all({0.0, body.spin, 0.0});

    ContactPointT<Pack> at;
    at.overlap = radius - distance;
    at.radius = radius;
    at.mass = mass;
    at.normal = (Pack(1.0) / distance) * (position - point);
    // Half an overlap inside either surface, as seen from the grain.
    const Pack reach = radius - Pack(0.5) * at.overlap;
    const Vec3T<Pack> arm = position - reach * at.normal - all(body.position);
    const Vec3T<Pack> velocity = grain_velocity - all(body.velocity) - cross(body_spin, arm);
    at.normal_velocity = dot(velocity, at.normal);
    at.slip_velocity =
        velocity - at.normal_velocity * at.normal - reach * cross(grain_spin, at.normal);
    const Vec3T<Pack> spin = grain_spin - body_spin;
    at.rolling_rate = spin - dot(spin, at.normal) * at.normal;

    typename View::LawHistory law_history;
    typename View::RollingHistory rolling_history;
    View::load(histories, law_history, rolling_history);
    const ContactForceT<Pack> contact = law.evaluate(at, law_history, time_step);
    const Vec3T<Pack> turning = rolling.evaluate(at, contact, rolling_history, time_step);
    View::store(histories, law_history, rolling_history);

    const Vec3T<Pack> on_grain = contact.normal * at.normal + contact.tangential;
    Rows(on_grain).store(Rows(reach * cross(contact.tangential, at.normal) + turning), pushes,
                         kGrainLoad);
    cross(arm, on_grain).y.store(force_moment_y);
    turning.y.store(couple_y);
    share = at.overlap / radius;
  }
};

}  // namespace grouser
