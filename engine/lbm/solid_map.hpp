// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/lbm/flow.hpp"
#include "engine/lbm/populations.hpp"

namespace grouser {

/// Which cells of a rank's block and its ghosts are fluid.
class SolidMap {
 public:
  static constexpr std::int16_t kFluid = -1;
  static constexpr std::int16_t kBeyond = -2;  ///< past an end of the lattice that is not periodic

  SolidMap(const FlowSettings& settings, const CellBlocks& blocks, const CellBox& box);

  /// kFluid, kBeyond or the number of the obstacle. Ghosts included.
  std::int16_t at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return cells_.empty() ? beyond(x, y, z) : cells_[index(x, y, z)];
  }
  bool is_fluid(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return at(x, y, z) == kFluid;
  }
  bool has_obstacles() const { return !cells_.empty(); }
  std::size_t bytes() const { return cells_.size() * sizeof(std::int16_t); }

 private:
  std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>(((z + box_.ghosts_z) * (box_.ny + 2) + y + 1) * (box_.nx + 2) +
                                    x + 1);
  }
  std::int16_t beyond(std::int64_t x, std::int64_t y, std::int64_t z) const;

  CellBlocks blocks_;
  CellBox box_;
  std::vector<std::int16_t> cells_;  // empty without obstacles
};

/// The point of the whole lattice that a cell of the block stands for: ghosts beyond a periodic end
/// are at the other one. Local.
Vec3 centre_of(const CellBlocks& blocks, std::int64_t x, std::int64_t y, std::int64_t z);

}  // namespace grouser
