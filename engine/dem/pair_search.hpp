// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/cell_grid.hpp"
#include "engine/core/particle.hpp"

namespace grouser {

/// Finds the grains near a grain by cells. Needed only while lists are made; local.
class PairSearch {
 public:
  /// @param particles must stay as they are while the search is in use
  /// @param skin      what is looked for beyond the sum of radii [m]
  PairSearch(const std::vector<Particle>& particles, double skin);

  /// Appends those grains behind grain `i` in memory that are closer to it than the sum of radii +
  /// skin. So each pair is listed once, under whichever of the two stands first.
  void list_behind(std::size_t i, std::vector<std::uint32_t>& partners) const;

 private:
  const std::vector<Particle>& particles_;
  double skin_;
  CellGrid grid_;
  std::vector<std::uint32_t> first_;  // of each cell's members
  std::vector<std::uint32_t> members_;
};

}  // namespace grouser
