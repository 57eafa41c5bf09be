// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/decomposition.hpp"
#include "engine/core/particle.hpp"

namespace grouser::bench {

/// The bed of configs/campaigns/wheel_71cm_full.yaml as far as messages see it.
struct ScalingBed {
  Vec3 high{1.2192, 0.5334, 0.2006};  ///< corner opposite to the origin [m]
  int count_x = 793;                  ///< grains along x; the product is the bed's count to 0.03 %
  int count_y = 347;
  int count_z = 131;
  double largest_radius = 1.145e-3;  ///< [m]
  double skin = 0.1619e-3;           ///< a tenth of the mean diameter, as the engine takes it [m]
  double contact_length = 1.65e-3;   ///< mean distance of the centres of a pair [m]

  /// A `count`th of it along x, for as many fewer ranks with the same share each.
  ScalingBed part(int count) const {
    ScalingBed bed = *this;
    bed.count_x = count_x / count;
    bed.high.x *= 1.0 * bed.count_x / count_x;
    return bed;
  }

  double grains() const { return 1.0 * count_x * count_y * count_z; }
  double reach() const { return 2.0 * largest_radius + skin; }
};

/// What a rank has. Grains that no other rank can have to do with are only counted.
struct BedShare {
  std::vector<Particle> grains;  ///< within two reaches of a face of the rank's box
  std::int64_t count = 0;        ///< of all
  std::int64_t outer = 0;        ///< of those that may have ghosts for partners
};

/// Grains of this rank's box: one at a random place of each cell of a lattice, which spreads them
/// evenly over any box without any getting whole layers. Radii follow the bed's size curve; the
/// grains overlap. Local.
BedShare bed_share(const ScalingBed& bed, const Decomposition& boxes, int rank);

/// Moves grains by up to `way` along each axis, each its own way. Local.
void stir(double way, std::vector<Particle>& grains);

}  // namespace grouser::bench
