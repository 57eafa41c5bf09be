// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/vec3.hpp"

namespace grouser {

/// A spherical grain. One record of 96 bytes, read whole by the contact sweep.
/// Velocities stand half a time step behind the position (leapfrog).
struct alignas(32) Particle {
  Vec3 position;        ///< of the centre [m]
  double radius = 0.0;  ///< [m]
  Vec3 velocity;        ///< [m s-1]
  double mass = 0.0;    ///< [kg]
  Vec3 spin;            ///< angular velocity [rad s-1]
  std::int64_t id = 0;  ///< 0 ... N-1, the same on every rank
};
static_assert(sizeof(Particle) == 96);

/// A grain as numbers in memory: how many, and where velocity and spin begin; the position is
/// first.
inline constexpr std::size_t kGrainStride = sizeof(Particle) / sizeof(double);
inline constexpr std::size_t kVelocityAt = offsetof(Particle, velocity) / sizeof(double);
inline constexpr std::size_t kSpinAt = offsetof(Particle, spin) / sizeof(double);

/// Whether two grains are closer than the sum of their radii + `gap` [m].
inline bool is_within(const Particle& a, const Particle& b, double gap) {
  const double reach = a.radius + b.radius + gap;
  return norm2(a.position - b.position) < reach * reach;
}

/// Moment of inertia of a homogeneous sphere over m r^2.
inline constexpr double kSphereInertia = 0.4;

/// Translational and rotational kinetic energy [J]. Local.
inline double kinetic_energy_of(const Particle& p) {
  return 0.5 * p.mass * (norm2(p.velocity) + kSphereInertia * p.radius * p.radius * norm2(p.spin));
}

}  // namespace grouser
