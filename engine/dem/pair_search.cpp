// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/pair_search.hpp"

#include <algorithm>

namespace grouser {
namespace {

CellGrid grid_over(const std::vector<Particle>& particles, double skin) {
  Vec3 low = particles.empty() ? Vec3{} : particles[0].position;
  Vec3 high = low;
  double radius = 0.0;
  for (const Particle& p : particles) {
    low = {std::min(low.x, p.position.x), std::min(low.y, p.position.y),
           std::min(low.z, p.position.z)};
    high = {std::max(high.x, p.position.x), std::max(high.y, p.position.y),
            std::max(high.z, p.position.z)};
    radius = std::max(radius, p.radius);
  }
  return {low, high, 2.0 * radius + skin, 2 * particles.size() + 64};
}

}  // namespace

PairSearch::PairSearch(const std::vector<Particle>& particles, double skin)
    : particles_(particles),
      skin_(skin),
      grid_(grid_over(particles, skin)),
      first_(grid_.cells() + 2, 0),
      members_(particles.size()) {
  const auto cell_of = [&](const Particle& p) { return grid_.index(grid_.cell_of(p.position)); };
  // Counted two places up, so that filling a cell moves its mark to where the next one begins.
  for (const Particle& p : particles) ++first_[cell_of(p) + 2];
  for (std::size_t c = 2; c < first_.size(); ++c) first_[c] += first_[c - 1];
  for (std::size_t i = 0; i < particles.size(); ++i)
    members_[first_[cell_of(particles[i]) + 1]++] = static_cast<std::uint32_t>(i);
}

void PairSearch::list_behind(std::size_t i, std::vector<std::uint32_t>& partners) const {
  const Particle& own = particles_[i];
  const std::array<int, 3> at = grid_.cell_of(own.position);
  const int z_low = std::max(at[2] - 1, 0);
  const int z_high = std::min(at[2] + 1, grid_.count(2) - 1);
  for (int x = std::max(at[0] - 1, 0); x <= std::min(at[0] + 1, grid_.count(0) - 1); ++x)
    for (int y = std::max(at[1] - 1, 0); y <= std::min(at[1] + 1, grid_.count(1) - 1); ++y) {
      // Cells along z follow one another, so their members do too; members rise within a cell.
      const std::uint32_t from = first_[grid_.index({x, y, z_low})];
      const std::uint32_t to = first_[grid_.index({x, y, z_high}) + 1];
      for (std::uint32_t m = from; m < to; ++m) {
        const std::uint32_t j = members_[m];
        if (j > i && is_within(own, particles_[j], skin_)) partners.push_back(j);
      }
    }
}

}  // namespace grouser
