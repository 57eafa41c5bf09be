// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/cell_blocks.hpp"

#include <limits>
#include <string>

#include "base/errors.hpp"
#include "engine/core/state_io.hpp"

namespace grouser {
namespace {

// A block that is not the only one needs two layers: conditions at faces look one cell inwards.
bool divides(std::int64_t cells, int blocks) { return blocks == 1 || cells >= 2 * blocks; }

}  // namespace

CellBlocks::CellBlocks(const CellCounts& cells, const std::array<bool, 3>& periodic,
                       const Communicator& ranks)
    : cells_(cells), periodic_(periodic) {
  // Of all grids that fit, the one with the smallest cuts.
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (int y = 1; y <= ranks.size(); ++y) {
    const int z = ranks.size() / y;
    if (y * z != ranks.size() || !divides(cells[1], y) || !divides(cells[2], z)) continue;
    const std::int64_t cut = (y - 1) * cells[2] + (z - 1) * cells[1];
    if (cut >= least) continue;
    least = cut;
    blocks_ = {1, y, z};
  }
  if (blocks_[1] * blocks_[2] != ranks.size())
    throw ConfigError({{.file = "",
                        .key = "ranks",
                        .problem = std::to_string(ranks.size()) + " ranks cannot share " +
                                   std::to_string(cells[1]) + " x " + std::to_string(cells[2]) +
                                   " rows of cells as a grid of blocks",
                        .hint = "each block needs two rows along y and z; take fewer ranks"}});
  at_ = {0, ranks.rank() % blocks_[1], ranks.rank() / blocks_[1]};
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a] = first_key(cells[a], blocks_[a], at_[a]);
    high_[a] = first_key(cells[a], blocks_[a], at_[a] + 1);
  }
}

int CellBlocks::owner_of(std::int64_t key) const {
  const std::int64_t row = key / cells_[0];
  const std::int64_t place[3] = {0, row % cells_[1], row / cells_[1]};
  std::array<int, 3> at{0, 0, 0};
  for (std::size_t a = 1; a < 3; ++a)
    while (place[a] >= first_key(cells_[a], blocks_[a], at[a] + 1)) ++at[a];
  return at[2] * blocks_[1] + at[1];
}

std::vector<int> CellBlocks::owners_within(const Vec3& at, double reach) const {
  const double centre[3] = {at.x, at.y, at.z};
  const auto is_near = [&](std::size_t axis, int block) {
    const auto low = static_cast<double>(first_key(cells_[axis], blocks_[axis], block));
    const auto high = static_cast<double>(first_key(cells_[axis], blocks_[axis], block + 1) - 1);
    const auto period = static_cast<double>(cells_[axis]);
    for (const double shift : {0.0, period, -period}) {
      if (shift != 0.0 && !periodic_[axis]) continue;
      if (centre[axis] + shift + reach >= low && centre[axis] + shift - reach <= high) return true;
    }
    return false;
  };
  std::vector<int> ranks;
  if (!is_near(0, 0)) return ranks;
  for (int z = 0; z < blocks_[2]; ++z)
    for (int y = 0; is_near(2, z) && y < blocks_[1]; ++y)
      if (is_near(1, y)) ranks.push_back(z * blocks_[1] + y);
  return ranks;
}

int CellBlocks::neighbour(int axis, int side) const {
  const auto a = static_cast<std::size_t>(axis);
  std::array<int, 3> at = at_;
  at[a] += side;
  if (at[a] < 0 || at[a] == blocks_[a]) {
    if (!periodic_[a]) return -1;
    at[a] = side < 0 ? blocks_[a] - 1 : 0;
  }
  return at[2] * blocks_[1] + at[1];
}

}  // namespace grouser
