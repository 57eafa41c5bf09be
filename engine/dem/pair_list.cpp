// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/pair_list.hpp"

#include <algorithm>
#include <limits>

#include "base/check.hpp"
#include "engine/dem/cell_grid.hpp"

namespace grouser {

void PairList::build(const std::vector<Particle>& particles, std::size_t owned, double skin) {
  GROUSER_CHECK(particles.size() < std::numeric_limits<std::uint32_t>::max());
  owned_ = owned;
  find_pairs(particles, skin);
  order_sides(particles);
}

void PairList::find_pairs(const std::vector<Particle>& particles, double skin) {
  start_.assign(1, 0);
  partner_.clear();
  if (particles.empty()) return;
  Vec3 low = particles[0].position;
  Vec3 high = low;
  double radius = 0.0;
  for (const Particle& p : particles) {
    low = {std::min(low.x, p.position.x), std::min(low.y, p.position.y),
           std::min(low.z, p.position.z)};
    high = {std::max(high.x, p.position.x), std::max(high.y, p.position.y),
            std::max(high.z, p.position.z)};
    radius = std::max(radius, p.radius);
  }
  const CellGrid grid(low, high, 2.0 * radius + skin, 2 * particles.size() + 64);
  std::vector<std::uint32_t> first(grid.cells() + 1, 0);
  std::vector<std::uint32_t> cell(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    cell[i] = static_cast<std::uint32_t>(grid.index(grid.cell_of(particles[i].position)));
    ++first[cell[i] + 1];
  }
  for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
  std::vector<std::uint32_t> members(particles.size());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < particles.size(); ++i)
    members[next[cell[i]]++] = static_cast<std::uint32_t>(i);

  for (std::size_t i = 0; i < owned_; ++i) {
    const std::array<int, 3> at = grid.cell_of(particles[i].position);
    const int z_low = std::max(at[2] - 1, 0);
    const int z_high = std::min(at[2] + 1, grid.count(2) - 1);
    for (int x = std::max(at[0] - 1, 0); x <= std::min(at[0] + 1, grid.count(0) - 1); ++x)
      for (int y = std::max(at[1] - 1, 0); y <= std::min(at[1] + 1, grid.count(1) - 1); ++y) {
        // Cells along z follow one another, so their members do too.
        const std::uint32_t from = first[grid.index({x, y, z_low})];
        const std::uint32_t to = first[grid.index({x, y, z_high}) + 1];
        for (std::uint32_t m = from; m < to; ++m) {
          const std::uint32_t j = members[m];
          if (j > i && is_within(particles[i], particles[j], skin)) partner_.push_back(j);
        }
      }
    start_.push_back(static_cast<std::uint32_t>(partner_.size()));
  }
  GROUSER_CHECK(partner_.size() < std::numeric_limits<std::int32_t>::max());
}

void PairList::order_sides(const std::vector<Particle>& particles) {
  side_start_.assign(owned_ + 1, 0);
  for (std::size_t i = 0; i < owned_; ++i)
    for (std::uint32_t k = start_[i]; k < start_[i + 1]; ++k) {
      ++side_start_[i + 1];
      if (partner_[k] < owned_) ++side_start_[partner_[k] + 1];
    }
  for (std::size_t i = 0; i < owned_; ++i) side_start_[i + 1] += side_start_[i];
  by_partner_.resize(side_start_[owned_]);
  std::vector<std::int64_t> partner_id(by_partner_.size());
  std::vector<std::uint32_t> next(side_start_.begin(), side_start_.end() - 1);
  const auto put = [&](std::size_t grain, std::uint32_t pair, std::int64_t other) {
    std::uint32_t place = next[grain]++;
    // Insertion sort: a grain has about ten neighbours.
    while (place > side_start_[grain] && partner_id[place - 1] > other) {
      partner_id[place] = partner_id[place - 1];
      by_partner_[place] = by_partner_[place - 1];
      --place;
    }
    partner_id[place] = other;
    by_partner_[place] = pair;
  };
  for (std::size_t i = 0; i < owned_; ++i)
    for (std::uint32_t k = start_[i]; k < start_[i + 1]; ++k) {
      put(i, k, particles[partner_[k]].id);
      if (partner_[k] < owned_) put(partner_[k], k, particles[i].id);
    }
  side_split_.resize(owned_);
  for (std::size_t i = 0; i < owned_; ++i)
    side_split_[i] = static_cast<std::uint32_t>(
        std::upper_bound(partner_id.begin() + side_start_[i],
                         partner_id.begin() + side_start_[i + 1], particles[i].id) -
        partner_id.begin());
}

}  // namespace grouser
