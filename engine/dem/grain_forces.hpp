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

/// What a step changes.
struct GrainGain {
  Vec3 velocity;  ///< [m s-1]
  Vec3 spin;      ///< [rad s-1]
};

/// The gain of a grain under its contacts and gravity alone, along -z. Local.
inline GrainGain plain_gain(const Particle& p, const GrainLoad& load, double time_step,
                            double gravity) {
  GrainGain gain;
  gain.velocity = (time_step / p.mass) * load.force;
  gain.velocity.z -= time_step * gravity;
  gain.spin = (time_step / (kSphereInertia * p.mass * p.radius * p.radius)) * load.moment;
  return gain;
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
