// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/halo.hpp"

#include <algorithm>

#include "engine/core/cell_grid.hpp"

namespace grouser {
namespace {

// Marks the grains on either side of a border that are near one of the other side. Both sides do
// so with the same numbers, and so agree.
class NearPairs {
 public:
  NearPairs(const std::vector<Particle>& particles, const std::vector<std::uint32_t>& own,
            const std::vector<Particle>& other, double skin)
      : is_own_near(own.size(), 0), is_other_near(other.size(), 0) {
    if (own.empty() || other.empty()) return;
    Vec3 low = other[0].position;
    Vec3 high = low;
    double radius = 0.0;
    for (const Particle& p : other) {
      low = {std::min(low.x, p.position.x), std::min(low.y, p.position.y),
             std::min(low.z, p.position.z)};
      high = {std::max(high.x, p.position.x), std::max(high.y, p.position.y),
              std::max(high.z, p.position.z)};
      radius = std::max(radius, p.radius);
    }
    for (const std::uint32_t i : own) radius = std::max(radius, particles[i].radius);
    const CellGrid grid(low, high, 2.0 * radius + skin, 2 * other.size() + 64);
    std::vector<std::uint32_t> first(grid.cells() + 2, 0);
    std::vector<std::uint32_t> members(other.size());
    const auto cell_of = [&](const Particle& p) { return grid.index(grid.cell_of(p.position)); };
    for (const Particle& p : other) ++first[cell_of(p) + 2];
    for (std::size_t c = 2; c < first.size(); ++c) first[c] += first[c - 1];
    for (std::uint32_t j = 0; j < other.size(); ++j) members[first[cell_of(other[j]) + 1]++] = j;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Particle& grain = particles[own[i]];
      const std::array<int, 3> at = grid.cell_of(grain.position);
      const auto begin = [&](std::size_t d) { return std::max(at[d] - 1, 0); };
      const auto end = [&](std::size_t d) { return std::min(at[d] + 1, grid.count(d) - 1); };
      for (int x = begin(0); x <= end(0); ++x)
        for (int y = begin(1); y <= end(1); ++y)
          for (std::uint32_t m = first[grid.index({x, y, begin(2)})];
               m < first[grid.index({x, y, end(2)}) + 1]; ++m) {
            const std::uint32_t j = members[m];
            if ((is_own_near[i] & is_other_near[j]) != 0 || !is_within(grain, other[j], skin))
              continue;
            is_own_near[i] = is_other_near[j] = 1;
          }
    }
  }

  std::vector<std::uint8_t> is_own_near;
  std::vector<std::uint8_t> is_other_near;
};

}  // namespace

void Halo::build(const Communicator& ranks, const Decomposition& boxes,
                 const std::vector<int>& neighbours, double largest_radius, double skin,
                 std::vector<Particle>& particles) {
  owned_ = particles.size();
  neighbours_.clear();
  std::vector<std::uint32_t> outer;
  const Box& own = boxes.box(ranks.rank());
  for (std::uint32_t i = 0; i < owned_; ++i)
    if (own.depth(particles[i].position) < reach(particles[i], largest_radius, skin))
      outer.push_back(i);
  std::vector<Bytes> out;
  for (const int rank : neighbours) {
    Neighbour& neighbour = neighbours_.emplace_back(Neighbour{rank, {}, 0});
    Bytes& records = out.emplace_back();
    const Box& box = boxes.box(rank);
    for (const std::uint32_t i : outer) {
      const double far = reach(particles[i], largest_radius, skin);
      if (box.distance2(particles[i].position) >= far * far) continue;
      neighbour.sent.push_back(i);
      append_bytes(records, &particles[i], 1);
    }
  }
  const std::vector<Bytes> in = ranks.exchange_with(neighbours, out);
  std::size_t sent = 0;
  for (std::size_t n = 0; n < neighbours_.size(); ++n) {
    Neighbour& neighbour = neighbours_[n];
    std::vector<Particle> theirs(in[n].size() / sizeof(Particle));
    ByteReader(in[n]).take(theirs.data(), theirs.size());
    const NearPairs near(particles, neighbour.sent, theirs, skin);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < neighbour.sent.size(); ++k)
      if (near.is_own_near[k] != 0) neighbour.sent[kept++] = neighbour.sent[k];
    neighbour.sent.resize(kept);
    neighbour.sent.shrink_to_fit();
    sent += kept;
    const std::size_t before = particles.size();
    for (std::size_t k = 0; k < theirs.size(); ++k)
      if (near.is_other_near[k] != 0) particles.push_back(theirs[k]);
    neighbour.ghosts = particles.size() - before;
  }
  out_.resize(sent);
}

void Halo::start(std::vector<Particle>& particles) {
  Particle* to = particles.data() + owned_;
  for (const Neighbour& neighbour : neighbours_) {
    messages_.receive(neighbour.rank, to, neighbour.ghosts * sizeof(Particle));
    to += neighbour.ghosts;
  }
  Particle* from = out_.data();
  for (const Neighbour& neighbour : neighbours_) {
    const Particle* const begin = from;
    for (const std::uint32_t i : neighbour.sent) *from++ = particles[i];
    messages_.send(neighbour.rank, begin, neighbour.sent.size() * sizeof(Particle));
  }
}

}  // namespace grouser
