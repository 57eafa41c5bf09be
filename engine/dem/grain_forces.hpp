// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/communicator.hpp"
#include "engine/core/particle.hpp"

namespace grouser {

/// What moves a grain in a step.
struct GrainLoad {
  Vec3 force;   ///< of all its contacts [N]
  Vec3 moment;  ///< about its centre [N m]
};

/// What a step changes. @tparam Real double, or Pack for several grains
template <class Real>
struct GrainGainT {
  Vec3T<Real> velocity;  ///< [m s-1]
  Vec3T<Real> spin;      ///< [rad s-1]
};
using GrainGain = GrainGainT<double>;

/// The gain of a grain of this radius [m] and mass [kg] under the force [N] and the moment [N m] of
/// its contacts and gravity alone, along -z. Local.
template <class Real>
inline GrainGainT<Real> plain_gain(const Real& radius, const Real& mass, const Vec3T<Real>& force,
                                   const Vec3T<Real>& moment, double time_step, double gravity) {
  GrainGainT<Real> gain;
  gain.velocity = (Real(time_step) / mass) * force;
  gain.velocity.z -= Real(time_step * gravity);
  gain.spin = (Real(time_step) / (Real(kSphereInertia) * mass * radius * radius)) * moment;
  return gain;
}
inline GrainGain plain_gain(const Particle& p, const GrainLoad& load, double time_step,
                            double gravity) {
  return plain_gain(p.radius, p.mass, load.force, load.moment, time_step, gravity);
}

/// Forces on grains beyond contacts and gravity, such as a fluid's: the world asks once a step and
/// grain, where all contacts are summed, so that forces may go with the velocity that comes out.
class GrainForces {
 public:
  virtual ~GrainForces() = default;

  /// Before the contacts of a step. @param particles those of this rank, then ghosts. Local.
  virtual void begin_step(const std::vector<Particle>& particles, std::size_t owned) = 0;

  /// The gain of an owned grain in this step; its position is of the middle of the step, its
  /// velocity and spin of the beginning. Threads ask at once, for each grain one of them. Local.
  virtual GrainGain gain(const Particle& particle, const GrainLoad& load) = 0;

  /// Appends what it remembers of a grain that goes to another rank, and takes it back there.
  /// Local.
  virtual void give(std::int64_t id, Bytes& to) = 0;
  virtual void take(std::int64_t id, ByteReader& from) = 0;
};

}  // namespace grouser
