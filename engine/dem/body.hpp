// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "base/vec3.hpp"
#include "engine/dem/laws/hertz_mindlin.hpp"
#include "engine/dem/mesh.hpp"

namespace grouser {

/// Where a rigid body is and how it moves. It turns about its y axis only (the axle).
/// The same on every rank.
struct BodyMotion {
  Vec3 position;       ///< of the body frame's origin [m]
  double angle = 0.0;  ///< about y, forward rolling positive [rad]
  Vec3 velocity;       ///< [m s-1]
  double spin = 0.0;   ///< about y [rad s-1]
};

/// A rigid triangle-mesh body and its surface against grains.
struct Body {
  std::string name;
  std::shared_ptr<const MeshSearch> search;
  Solid solid;
  Surface surface;
  bool turns = false;  ///< may turn about its y axis
  BodyMotion motion;

  bool is_at_rest() const { return motion.spin == 0.0 && norm2(motion.velocity) == 0.0; }
};

/// Turns vectors between a body's frame and the world.
class BodyFrame {
 public:
  explicit BodyFrame(const BodyMotion& motion)
      : origin_(motion.position), cos_(std::cos(motion.angle)), sin_(std::sin(motion.angle)) {}

  Vec3 to_body(const Vec3& at) const { return turn(at - origin_, -sin_); }
  Vec3 to_world(const Vec3& at) const { return origin_ + turn(at, sin_); }

 private:
  // A right-handed turn about y takes z to x.
  Vec3 turn(const Vec3& v, double sine) const {
    return {cos_ * v.x + sine * v.z, v.y, cos_ * v.z - sine * v.x};
  }

  Vec3 origin_;
  double cos_;
  double sin_;
};

}  // namespace grouser
