// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/vec3.hpp"

namespace grouser {

/// The part of space that one rank owns: low <= x < high along each axis [m]. Faces at the edge of
/// the domain are at infinity.
struct Box {
  Vec3 low;
  Vec3 high;

  /// Squared distance to a point or another box, 0 inside [m2]. Local.
  double distance2(const Vec3& at) const;
  double distance2(const Box& other) const;
  /// How far a point inside is from the nearest face [m]. Local.
  double depth(const Vec3& at) const;
};

/// Which rank owns which part of space: boxes that cuts across an axis leave, one cut within
/// another. Every rank knows all of them, so all agree on the owner of any point.
class Decomposition {
 public:
  /// @param boxes one to each rank; they fill space and can be parted by a plane again and again
  explicit Decomposition(std::vector<Box> boxes);

  /// Boxes of about the same volume within [low, high], as near to cubes as halving across the
  /// longest side makes them. Ranks that follow one another are close together. Local.
  static Decomposition even(const Vec3& low, const Vec3& high, int count);

  /// Every point has exactly one: on a cut it is the rank above, beyond the domain the nearest one.
  /// Local.
  int owner_of(const Vec3& position) const;

  int size() const { return static_cast<int>(boxes_.size()); }
  const Box& box(int rank) const { return boxes_[static_cast<std::size_t>(rank)]; }

  /// Other ranks whose boxes are within `reach` [m] of this rank's, by number; however narrow boxes
  /// are. If a has b, b has a. Local.
  std::vector<int> neighbours(int rank, double reach) const;

 private:
  // A cut across axis `axis` at `at`. Sides are places of further cuts, or -1 - rank.
  struct Cut {
    int axis;
    double at;
    int below;
    int above;
  };

  int part(std::vector<int> ranks);

  std::vector<Box> boxes_;
  std::vector<Cut> cuts_;
  int first_ = -1;
};

}  // namespace grouser
