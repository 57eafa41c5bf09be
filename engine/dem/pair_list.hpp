// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/particle.hpp"

namespace grouser {

/// Pairs of grains that may come to touch before the list is made again, each listed once, under
/// whichever of the two stands first in memory. Ghosts stand behind owned grains, so every pair is
/// listed under an owned one.
class PairList {
 public:
  /// Lists the pairs closer than the sum of radii + `skin` [m] that have an owned grain.
  /// @param particles owned grains first, then ghosts. Local.
  void build(const std::vector<Particle>& particles, std::size_t owned, double skin);

  std::size_t owned() const { return owned_; }
  std::size_t pairs() const { return partner_.size(); }

  /// Pairs listed under owned grain `i` are begin(i) ... end(i)-1.
  std::uint32_t begin(std::size_t i) const { return start_[i]; }
  std::uint32_t end(std::size_t i) const { return start_[i + 1]; }
  /// The second grain of a pair.
  std::uint32_t partner(std::size_t pair) const { return partner_[pair]; }

  /// Places in by_partner() of owned grain `i`'s pairs, under whichever grain they are listed:
  /// first those with partners of lower id, from side_split(i) on those with higher id.
  std::uint32_t side_begin(std::size_t i) const { return side_start_[i]; }
  std::uint32_t side_split(std::size_t i) const { return side_split_[i]; }
  std::uint32_t side_end(std::size_t i) const { return side_start_[i + 1]; }
  /// Pairs grain by grain, by rising id of the partner.
  const std::vector<std::uint32_t>& by_partner() const { return by_partner_; }

 private:
  void find_pairs(const std::vector<Particle>& particles, double skin);
  void order_sides(const std::vector<Particle>& particles);

  std::size_t owned_ = 0;
  std::vector<std::uint32_t> start_;
  std::vector<std::uint32_t> partner_;
  std::vector<std::uint32_t> side_start_;
  std::vector<std::uint32_t> side_split_;
  std::vector<std::uint32_t> by_partner_;
};

/// Whether two grains are closer than the sum of their radii + `gap` [m].
inline bool is_within(const Particle& a, const Particle& b, double gap) {
  const double reach = a.radius + b.radius + gap;
  return norm2(a.position - b.position) < reach * reach;
}

}  // namespace grouser
