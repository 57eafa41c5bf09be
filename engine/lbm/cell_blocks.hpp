// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec3.hpp"
#include "engine/core/communicator.hpp"

namespace grouser {

/// Cells of a lattice: along x, y and z.
using CellCounts = std::array<std::int64_t, 3>;

/// Which rank owns which cells: a regular grid of blocks over y and z (over y alone for a flat
/// lattice). Rows along x stay whole.
class CellBlocks {
 public:
  /// @param periodic  whether the last block's neighbour is the first, along x, y and z
  /// @throws ConfigError when there are more ranks than rows to share out. Local.
  CellBlocks(const CellCounts& cells, const std::array<bool, 3>& periodic,
             const Communicator& ranks);

  const CellCounts& cells() const { return cells_; }  ///< of the whole lattice
  bool periodic(int axis) const { return periodic_[static_cast<std::size_t>(axis)]; }
  std::int64_t low(int axis) const { return low_[static_cast<std::size_t>(axis)]; }
  /// One past the last.
  std::int64_t high(int axis) const { return high_[static_cast<std::size_t>(axis)]; }
  std::int64_t count(int axis) const { return high(axis) - low(axis); }
  bool owns(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return x >= low(0) && x < high(0) && y >= low(1) && y < high(1) && z >= low(2) && z < high(2);
  }
  /// Rank beyond the face of this block at the low (-1) or high (1) end of axis 1 or 2, which may
  /// be this one; -1 at the end of the lattice.
  int neighbour(int axis, int side) const;

  /// A cell's place in the order x fastest, then y, then z: the key of its row in a checkpoint.
  std::int64_t key(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return (z * cells_[1] + y) * cells_[0] + x;
  }
  int owner_of(std::int64_t key) const;
  /// Ranks with cells within `reach` along every axis of a point or of its images beyond periodic
  /// ends, each once, by number. Local.
  std::vector<int> owners_within(const Vec3& at, double reach) const;

 private:
  CellCounts cells_;
  std::array<bool, 3> periodic_;
  std::array<int, 3> blocks_{1, 1, 1};
  std::array<int, 3> at_{0, 0, 0};
  CellCounts low_{0, 0, 0};
  CellCounts high_{0, 0, 0};
};

}  // namespace grouser
