// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/core/communicator.hpp"
#include "engine/core/decomposition.hpp"
#include "engine/core/particle.hpp"

namespace grouser {

/// Copies ("ghosts") of the neighbours' particles near this rank's column. Two sweeps, x then y,
/// so that corners arrive through the neighbour between.
class Halo {
 public:
  /// Appends ghosts to `particles`, which must hold owned particles only, and remembers who goes
  /// where. @param reach width of the halo [m]. Collective.
  void build(const Communicator& ranks, const Decomposition& columns, double reach,
             std::vector<Particle>& particles);

  /// Renews positions, velocities and spins of the ghosts. Collective.
  void update(const Communicator& ranks, std::vector<Particle>& particles);

 private:
  struct Leg {
    int to = -1;
    int from = -1;
    std::vector<std::uint32_t> sent;
    std::size_t first_ghost = 0;
    std::size_t ghosts = 0;
  };

  std::array<Leg, 4> legs_;
  std::vector<Vec3> out_;
  std::vector<Vec3> in_;
};

}  // namespace grouser
