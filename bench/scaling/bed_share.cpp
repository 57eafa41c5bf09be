// SPDX-License-Identifier: BSD-3-Clause
#include "bench/scaling/bed_share.hpp"

#include <algorithm>

namespace grouser::bench {
namespace {

// Splitmix64: a number in [0, 1) that is the same on all ranks.
double chance(std::int64_t id, int draw) {
  auto z = static_cast<std::uint64_t>(id * 8 + draw) + 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

std::vector<Particle> bed_share(const ScalingBed& bed, const Decomposition& columns, int rank) {
  const Vec3 cell{bed.high.x / bed.count_x, bed.high.y / bed.count_y, bed.high.z / bed.count_z};
  const auto first = [](double low, double step) {
    return std::max(static_cast<int>(low / step) - 1, 0);
  };
  const auto end = [](double high, double step, int count) {
    return std::min(static_cast<int>(high / step) + 2, count);
  };
  std::vector<Particle> grains;
  for (int x = first(columns.low_x(), cell.x); x < end(columns.high_x(), cell.x, bed.count_x); ++x)
    for (int y = first(columns.low_y(), cell.y); y < end(columns.high_y(), cell.y, bed.count_y);
         ++y)
      for (int z = 0; z < bed.count_z; ++z) {
        Particle grain;
        grain.id = (std::int64_t{x} * bed.count_y + y) * bed.count_z + z;
        grain.position = {(x + chance(grain.id, 0)) * cell.x, (y + chance(grain.id, 1)) * cell.y,
                          (z + chance(grain.id, 2)) * cell.z};
        if (columns.owner_of(grain.position) == rank) grains.push_back(grain);
      }
  return grains;
}

void stir(double way, std::vector<Particle>& grains) {
  for (Particle& grain : grains) {
    grain.position.x += way * (2.0 * chance(grain.id, 3) - 1.0);
    grain.position.y += way * (2.0 * chance(grain.id, 4) - 1.0);
  }
}

}  // namespace grouser::bench
