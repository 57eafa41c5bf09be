// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "base/vec3.hpp"
#include "engine/core/exact_sum.hpp"

namespace grouser {

/// A solid ball in the fluid, in lattice units and the whole lattice's coordinates.
struct ImmersedBall {
  Vec3 centre;
  double radius = 0.0;  ///< over 1/2
  Vec3 velocity;
  Vec3 spin;  ///< [rad per step]
};

/// A solid body with a closed surface of triangles, likewise; not across periodic ends.
struct ImmersedBody {
  std::vector<Vec3> corners;               ///< of the facets
  std::vector<std::array<int, 3>> facets;  ///< three corners each
  Vec3 centre;                             ///< that it turns about
  Vec3 velocity;
  Vec3 spin;  ///< [rad per step]
};

/// How much larger than a grain the ball must be that is immersed in its place [cells], so that the
/// drag of creeping flow is the grain's: cells that are covered in part let some fluid through,
/// which is of second order in the cell. Calibrated (as Ladd 1994 does) on periodic arrays of
/// spheres of 7 and 12 cells at relaxation times from 0.56 to 2 of bgk and trt; what is left is in
/// docs/physics/coupling.md. @param radius [cells] @param magic  see CollisionParameters; of bgk it
/// is the square of 3 viscosity. Local.
inline double immersed_excess(double radius, double viscosity_lu, double magic) {
  return (0.86 * 3.0 * viscosity_lu + 1.14 * std::sqrt(magic)) / radius;
}

/// What the fluid gave one solid in a step, in the cells of this rank.
struct ImmersedLoad {
  /// Sums are cut to multiples of 2^-60: forces on single rows are small.
  static constexpr double kScale = 0x1p20;

  std::array<ExactSum, 3> force;   ///< times kScale
  std::array<ExactSum, 3> moment;  ///< about its centre, times kScale
  ExactSum volume;                 ///< of fluid that a body covers [cells]; not of balls

  void add(const Vec3& f, const Vec3& m) {
    const double values[6] = {f.x, f.y, f.z, m.x, m.y, m.z};
    for (std::size_t a = 0; a < 3; ++a) {
      force[a].add(kScale * values[a]);
      moment[a].add(kScale * values[a + 3]);
    }
  }
  void add(const ImmersedLoad& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      force[a].add(other.force[a]);
      moment[a].add(other.moment[a]);
    }
    volume.add(other.volume);
  }
  Vec3 force_lu() const { return value_of(force); }
  Vec3 moment_lu() const { return value_of(moment); }

 private:
  static Vec3 value_of(const std::array<ExactSum, 3>& sums) {
    return (1.0 / kScale) * Vec3{sums[0].value(), sums[1].value(), sums[2].value()};
  }
};

}  // namespace grouser
