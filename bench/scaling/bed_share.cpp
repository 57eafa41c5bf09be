// SPDX-License-Identifier: BSD-3-Clause
#include "bench/scaling/bed_share.hpp"

#include <algorithm>

#include "engine/core/halo.hpp"

namespace grouser::bench {
namespace {

// Splitmix64: a number in [0, 1) that is the same on all ranks.
double chance(std::int64_t id, int draw) {
  auto z = static_cast<std::uint64_t>(id * 8 + draw) + 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

// Diameter of the bed's size curve [m]; points as in the campaign file.
double diameter(double finer) {
  constexpr double kCurve[][2] = {{0.00, 0.76e-3}, {0.01, 1.20e-3}, {0.07, 1.35e-3},
                                  {0.25, 1.50e-3}, {0.50, 1.62e-3}, {0.75, 1.74e-3},
                                  {0.93, 1.89e-3}, {0.99, 2.04e-3}, {1.00, 2.29e-3}};
  int i = 1;
  while (kCurve[i][0] < finer) ++i;
  const double part = (finer - kCurve[i - 1][0]) / (kCurve[i][0] - kCurve[i - 1][0]);
  return kCurve[i - 1][1] + part * (kCurve[i][1] - kCurve[i - 1][1]);
}

}  // namespace

BedShare bed_share(const ScalingBed& bed, const Decomposition& boxes, int rank) {
  const Vec3 cell{bed.high.x / bed.count_x, bed.high.y / bed.count_y, bed.high.z / bed.count_z};
  const auto first = [](double low, double step) {
    return static_cast<int>(std::max(low / step - 1.0, 0.0));
  };
  const auto end = [](double high, double step, int count) {
    return static_cast<int>(std::min(high / step + 2.0, 1.0 * count));
  };
  const Box& box = boxes.box(rank);
  BedShare share;
  for (int x = first(box.low.x, cell.x); x < end(box.high.x, cell.x, bed.count_x); ++x)
    for (int y = first(box.low.y, cell.y); y < end(box.high.y, cell.y, bed.count_y); ++y)
      for (int z = first(box.low.z, cell.z); z < end(box.high.z, cell.z, bed.count_z); ++z) {
        Particle grain;
        grain.id = (std::int64_t{x} * bed.count_y + y) * bed.count_z + z;
        grain.position = {(x + chance(grain.id, 0)) * cell.x, (y + chance(grain.id, 1)) * cell.y,
                          (z + chance(grain.id, 2)) * cell.z};
        if (boxes.owner_of(grain.position) != rank) continue;
        ++share.count;
        if (box.depth(grain.position) > 2.0 * bed.reach()) continue;
        grain.radius = 0.5 * diameter(chance(grain.id, 6));
        if (box.depth(grain.position) < Halo::reach(grain, bed.largest_radius, bed.skin))
          ++share.outer;
        share.grains.push_back(grain);
      }
  return share;
}

void stir(double way, std::vector<Particle>& grains) {
  for (Particle& grain : grains) {
    grain.position.x += way * (2.0 * chance(grain.id, 3) - 1.0);
    grain.position.y += way * (2.0 * chance(grain.id, 4) - 1.0);
    grain.position.z += way * (2.0 * chance(grain.id, 5) - 1.0);
  }
}

}  // namespace grouser::bench
