// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/communicator.hpp"
#include "engine/core/decomposition.hpp"
#include "engine/core/particle.hpp"

namespace grouser {

/// Copies ("ghosts") of other ranks' grains that this rank's grains may touch. Each comes straight
/// from its owner, as a whole record.
class Halo {
 public:
  explicit Halo(const Communicator& ranks) : messages_(ranks) {}

  /// Appends ghosts to `particles`, which must hold owned grains only, and remembers who goes
  /// where: all that are within the sum of radii + `skin` [m] of one of this rank's grains.
  /// @param neighbours ranks with grains that near, and perhaps more; see Decomposition
  /// Collective.
  void build(const Communicator& ranks, const Decomposition& boxes,
             const std::vector<int>& neighbours, double largest_radius, double skin,
             std::vector<Particle>& particles);

  /// Grains that are deeper than this in their rank's box have no ghosts for partners [m]. Local.
  static double reach(const Particle& p, double largest_radius, double skin) {
    // A hair more, so that rounding at a box's face loses no pair.
    return (p.radius + largest_radius + skin) * (1.0 + 1e-9);
  }

  /// Begins to renew the ghosts. Until finish() nobody may look at them, nor may `particles` move
  /// in memory; owned grains may be looked at and moved on. Collective.
  void start(std::vector<Particle>& particles);
  void finish() { messages_.finish(); }

 private:
  struct Neighbour {
    int rank;
    std::vector<std::uint32_t> sent;
    std::size_t ghosts;
  };

  Messages messages_;
  std::vector<Neighbour> neighbours_;
  std::size_t owned_ = 0;
  std::vector<Particle> out_;
};

}  // namespace grouser
