// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "base/case.hpp"
#include "base/size_curve.hpp"
#include "engine/dem/world.hpp"

namespace grouser {

/// Places of the random loose filling: a lattice of cells as wide as the largest grain, filled from
/// the floor up, each with one grain at a random place inside. Sizes and places depend on seed and
/// id alone, so that every rank can make any grain without the others.
class Filling {
 public:
  explicit Filling(const Case& input);
  std::int64_t count() const { return count_; }
  double height() const { return height_; }  ///< of the loose column [m]
  Particle particle(std::int64_t id) const;

 private:
  double diameter(std::int64_t id) const;

  SizeCurve sizes_;
  std::uint64_t seed_;
  double density_;
  Vec3 cell_;
  std::int64_t along_x_ = 0;
  std::int64_t along_y_ = 0;
  std::int64_t count_ = 0;
  double height_ = 0.0;
};

/// Kinetic energy per grain below which the bed of a case counts as settled [J].
double settled_energy(const Case& input);

/// Mean height of the undisturbed surface in a strip of the bed [m]: mean over square columns, one
/// largest grain wide, of the highest grain top in each. Collective.
double surface_level(const World& world, double x_low, double x_high, double y_low, double y_high);

}  // namespace grouser
