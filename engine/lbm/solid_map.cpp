// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/solid_map.hpp"

namespace grouser {
namespace {

std::int64_t wrapped(const CellBlocks& blocks, int axis, std::int64_t local) {
  const std::int64_t n = blocks.cells()[static_cast<std::size_t>(axis)];
  const std::int64_t global = local + blocks.low(axis);
  return blocks.periodic(axis) ? (global + n) % n : global;
}

}  // namespace

Vec3 centre_of(const CellBlocks& blocks, std::int64_t x, std::int64_t y, std::int64_t z) {
  return {static_cast<double>(wrapped(blocks, 0, x)), static_cast<double>(wrapped(blocks, 1, y)),
          static_cast<double>(wrapped(blocks, 2, z))};
}

SolidMap::SolidMap(const FlowSettings& settings, const CellBlocks& blocks, const CellBox& box)
    : blocks_(blocks), box_(box) {
  if (settings.obstacles.empty()) return;
  cells_.resize(index(box.nx, box.ny, box.nz - 1 + box.ghosts_z) + 1);
  for (std::int64_t z = -box.ghosts_z; z < box.nz + box.ghosts_z; ++z)
    for (std::int64_t y = -1; y <= box.ny; ++y)
      for (std::int64_t x = -1; x <= box.nx; ++x) {
        std::int16_t& cell = cells_[index(x, y, z)];
        cell = beyond(x, y, z);
        const Vec3 centre = centre_of(blocks, x, y, z);
        for (std::size_t o = 0; o < settings.obstacles.size() && cell == kFluid; ++o)
          if (settings.obstacles[o].distance(centre) < 0.0) cell = static_cast<std::int16_t>(o);
      }
}

std::int16_t SolidMap::beyond(std::int64_t x, std::int64_t y, std::int64_t z) const {
  const std::int64_t at[3] = {x, y, z};
  for (int a = 0; a < 3; ++a) {
    const std::int64_t global = at[a] + blocks_.low(a);
    if (!blocks_.periodic(a) &&
        (global < 0 || global >= blocks_.cells()[static_cast<std::size_t>(a)]))
      return kBeyond;
  }
  return kFluid;
}

}  // namespace grouser
