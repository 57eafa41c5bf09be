// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bed_measure.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/cell_grid.hpp"

namespace grouser::bench {

BedMeasure measure_bed(const std::vector<Particle>& grains, const Case& input) {
  BedMeasure bed;
  double radius = 0.0;
  double top = 0.0;
  for (const Particle& p : grains) {
    bed.kinetic_energy +=
        0.5 * p.mass * (norm2(p.velocity) + 0.4 * p.radius * p.radius * norm2(p.spin));
    radius = std::max(radius, p.radius);
    top = std::max(top, p.position.z);
  }
  const CellGrid grid({0.0, 0.0, 0.0}, {input.box.length, input.box.width, top}, 2.0 * radius,
                      2 * grains.size());
  std::vector<std::vector<std::size_t>> members(grid.cells());
  double contacts = 0.0;
  // Each grain meets those before it.
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const Particle& a = grains[i];
    const auto at = grid.cell_of(a.position);
    const auto from = [&](std::size_t d) { return std::max(at[d] - 1, 0); };
    const auto to = [&](std::size_t d) { return std::min(at[d] + 1, grid.count(d) - 1); };
    for (int x = from(0); x <= to(0); ++x)
      for (int y = from(1); y <= to(1); ++y)
        for (int z = from(2); z <= to(2); ++z)
          for (const std::size_t j : members[grid.index({x, y, z})]) {
            const Particle& b = grains[j];
            const double reach = a.radius + b.radius;
            const double overlap = reach - std::sqrt(norm2(a.position - b.position));
            if (overlap <= 0.0) continue;
            contacts += 1.0;
            bed.mean_overlap += overlap;
            bed.mean_radius += a.radius * b.radius / reach;
            bed.mean_mass += a.mass * b.mass / (a.mass + b.mass);
          }
    members[grid.index(at)].push_back(i);
  }
  bed.coordination = 2.0 * contacts / static_cast<double>(grains.size());
  for (double* mean : {&bed.mean_overlap, &bed.mean_radius, &bed.mean_mass})
    *mean /= std::max(contacts, 1.0);
  return bed;
}

}  // namespace grouser::bench
