// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <limits>
#include <mutex>

#include "base/check.hpp"
#include "engine/dem/pair_contacts.hpp"
#include "engine/dem/pair_pack.hpp"
#include "engine/dem/pair_search.hpp"

namespace grouser {
namespace {

// Steps that the slots should last at the present speed, within these shares of the skin.
constexpr double kSlotSteps = 24.0;
constexpr double kLeastGap = 0.01;
constexpr double kLargestGap = 0.5;

}  // namespace

void PairContacts::build(const std::vector<Particle>& particles, std::size_t owned, double skin) {
  // Places of grains are held in 32 bits.
  GROUSER_CHECK(particles.size() <
                std::numeric_limits<std::uint32_t>::max() / sizeof(Particle) * sizeof(double));
  owned_ = owned;
  skin_ = skin;
  kept_.sort();
  mark_fast(particles);
  start_plan();
  {
    const PairSearch search(particles, skin);
    std::vector<std::vector<std::uint32_t>> partners(threads_.count());
    std::vector<bool> is_built(blocks_.size(), false);
    std::size_t freed = 0;
    std::mutex freeing;
    threads_.hand_out(blocks_.size(), [&](std::size_t b, std::size_t share) {
      list_pairs(search, b, partners[share]);
      make_slots(particles, b, desks_[share].slots,
                 [&](std::size_t i, std::size_t j) { return kept(particles, i, j); });
      // Pairs are listed under the grain in front, so no later block asks for these.
      const std::lock_guard<std::mutex> lock(freeing);
      is_built[b] = true;
      while (freed < blocks_.size() && is_built[freed]) kept_.free_bucket(freed++);
    });
  }
  kept_.clear();
  plan_sweep(particles);
}

void PairContacts::start_plan() {
  blocks_.clear();
  blocks_.resize((owned_ + kBlock - 1) / kBlock, Block(history_width()));
  plan_.chunks.assign((owned_ + kChunk - 1) / kChunk, {});
}

void PairContacts::list_pairs(const PairSearch& search, std::size_t b,
                              std::vector<std::uint32_t>& partners) {
  Block& block = blocks_[b];
  partners.clear();
  block.start.assign(1, 0);
  for (std::size_t i = b * kBlock; i < last_of(b); ++i) {
    search.list_behind(i, partners);
    block.start.push_back(static_cast<std::uint32_t>(partners.size()));
  }
  block.partner.assign(partners.begin(), partners.end());
}

const double* PairContacts::kept(const std::vector<Particle>& particles, std::size_t i,
                                 std::size_t j) const {
  const double* const history = kept_.find(static_cast<std::uint32_t>(i), particles[j].id);
  if (history != nullptr || j >= owned_) return history;
  return kept_.find(static_cast<std::uint32_t>(j), particles[i].id);
}

// The speeds are those of the owner's last step on every rank, so a grain and its ghosts agree.
void PairContacts::mark_fast(const std::vector<Particle>& particles) {
  is_fast_.resize(particles.size());
  const double limit2 = fast_speed_ * fast_speed_;
  threads_.split(particles.size(), [&](std::size_t first, std::size_t last, std::size_t) {
    for (std::size_t i = first; i < last; ++i)
      is_fast_[i] = norm2(particles[i].velocity) > limit2 ? 1 : 0;
  });
  const double way = std::min(slow_speed_, fast_speed_) * time_step_;
  gap_ = std::clamp(2.0 * kSlotSteps * way, kLeastGap * skin_, kLargestGap * skin_);
  travel_ = 0.0;
}

bool PairContacts::needs_slot(const std::vector<Particle>& particles, std::size_t i,
                              std::size_t j) const {
  return is_fast_[i] != 0 || is_fast_[j] != 0 || is_within(particles[i], particles[j], gap_);
}

// Finds the pairs of a block that may touch soon. `of(i, j)` is the history of a pair that touches
// already, else null.
template <class History>
void PairContacts::make_slots(const std::vector<Particle>& particles, std::size_t b,
                              PairSlots& scratch, const History& of) {
  Block& block = blocks_[b];
  block.chunk_end.clear();
  scratch.clear();
  for (std::size_t first = b * kBlock; first < last_of(b); first += kChunk) {
    SweepPlan::Chunk& chunk = plan_.chunks[first / kChunk];
    const std::size_t before = scratch.size();
    std::size_t front = first;
    chunk.has_ghosts = false;
    for (std::size_t i = first; i < std::min(first + kChunk, last_of(b)); ++i) {
      const std::size_t at = i - b * kBlock;
      for (std::uint32_t k = block.start[at]; k < block.start[at + 1]; ++k) {
        const std::size_t j = block.partner[k];
        if (!needs_slot(particles, i, j)) continue;
        scratch.add(particles, i, j, of(i, j));
        if (j < owned_) {
          front = std::max(front, j);
        } else {
          chunk.has_ghosts = true;
        }
      }
    }
    scratch.pad();
    block.chunk_end.push_back(static_cast<std::uint32_t>(scratch.size()));
    chunk.slots = static_cast<std::uint32_t>(scratch.size() - before);
    chunk.front = static_cast<std::uint32_t>(front / kChunk);
  }
  block.slots = scratch;
}

void PairContacts::refresh(const std::vector<Particle>& particles) {
  mark_fast(particles);
  threads_.hand_out(blocks_.size(), [&](std::size_t b, std::size_t share) {
    refresh(particles, b, desks_[share].slots);
  });
  plan_sweep(particles);
}

void PairContacts::refresh(const std::vector<Particle>& particles, std::size_t b,
                           PairSlots& scratch) {
  // Old slots stand in the order of the list too, so one pass finds them.
  const PairSlots old = std::move(blocks_[b].slots);
  blocks_[b].slots = PairSlots(history_width());
  std::size_t at = 0;
  std::vector<double> values(history_width());
  const auto first = [&](std::size_t slot) { return std::min(old.lower(slot), old.higher(slot)); };
  const auto second = [&](std::size_t slot) { return std::max(old.lower(slot), old.higher(slot)); };
  make_slots(particles, b, scratch, [&](std::size_t i, std::size_t j) -> const double* {
    while (at < old.size() && (old.is_padding(at) || first(at) < i)) ++at;
    for (std::size_t slot = at; slot < old.size() && first(slot) == i; ++slot) {
      if (second(slot) != j || !old.is_touching(slot)) continue;
      old.history_of(slot, values.data());
      return values.data();
    }
    return nullptr;
  });
}

// Finds out who evaluates what and lists each grain's slots by partner id.
void PairContacts::plan_sweep(const std::vector<Particle>& particles) {
  has_new_slots_ = true;
  plan_.make(threads_.count());
  if (results_.size() < plan_.results * kPairResult) results_.resize(plan_.results * kPairResult);
  side_start_.resize(owned_ + 1);
  by_count_.resize(owned_);
  // Where a grain's sides begin is the number of sides before it: each share counts its own first.
  std::vector<std::uint32_t> begin(threads_.count() + 1, 0);
  threads_.run([&](std::size_t share) {
    const auto [first, last] = grains_of(share);
    std::fill(side_start_.begin() + first, side_start_.begin() + last, 0);
    std::uint32_t sides = 0;
    each_side(share, [&](std::uint32_t own, std::uint32_t, std::uint32_t) {
      ++side_start_[own];
      ++sides;
    });
    begin[share + 1] = sides;
  });
  for (std::size_t share = 1; share < begin.size(); ++share) begin[share] += begin[share - 1];
  side_start_[owned_] = begin.back();
  sides_.resize(begin.back());
  threads_.run([&](std::size_t share) { order_sides(particles, share, begin[share]); });
  threads_.hand_out(plan_.chunks.size(),
                    [&](std::size_t chunk, std::size_t) { order_by_count(chunk); });
}

// Calls visit(grain, partner, side) for the slots of the share's grains, also where others evaluate
// them; two of one pair when both grains are the share's.
template <class Visit>
void PairContacts::each_side(std::size_t share, const Visit& visit) const {
  const auto [first, last] = grains_of(share);
  const auto is_own = [=](std::uint32_t grain) {
    return grain - static_cast<std::uint32_t>(first) < static_cast<std::uint32_t>(last - first);
  };
  if (first == last) return;
  for (std::size_t c = plan_.chunks[plan_.shares[share].first].back; c < plan_.shares[share].last;
       ++c) {
    const Block& block = blocks_[c / kChunksOfBlock];
    const std::size_t at = c % kChunksOfBlock;
    std::uint32_t side = 2 * plan_.chunks[c].place;
    for (std::uint32_t slot = at == 0 ? 0 : block.chunk_end[at - 1]; slot < block.chunk_end[at];
         ++slot, side += 2) {
      if (block.slots.is_padding(slot)) continue;
      const std::uint32_t lower = block.slots.lower(slot);
      const std::uint32_t higher = block.slots.higher(slot);
      if (is_own(lower)) visit(lower, higher, side);
      if (is_own(higher)) visit(higher, lower, side + 1);
    }
  }
}

// @param begin of the sides of the share's first grain; its grains' sides have been counted
void PairContacts::order_sides(const std::vector<Particle>& particles, std::size_t share,
                               std::uint32_t begin) {
  const auto [first, last] = grains_of(share);
  std::vector<std::uint32_t> next;
  next.reserve(static_cast<std::size_t>(last - first));
  std::uint32_t end = begin;
  for (std::ptrdiff_t i = first; i < last; ++i) {
    next.push_back(end);
    end += std::exchange(side_start_[static_cast<std::size_t>(i)], end);
  }
  std::vector<std::uint32_t> partner(end - begin);
  each_side(share, [&](std::uint32_t own, std::uint32_t other, std::uint32_t side) {
    // Insertion sort: a grain has about five slots.
    std::uint32_t at = next[own - static_cast<std::size_t>(first)]++;
    for (; at > side_start_[own] && particles[partner[at - 1 - begin]].id > particles[other].id;
         --at) {
      partner[at - begin] = partner[at - 1 - begin];
      sides_[at] = sides_[at - 1];
    }
    partner[at - begin] = other;
    sides_[at] = side;
  });
}

void PairContacts::order_by_count(std::size_t chunk) {
  const std::size_t first = chunk * kChunk;
  const std::size_t last = std::min(first + kChunk, owned_);
  std::array<std::vector<std::uint8_t>, 16> with;
  for (std::size_t i = first; i < last; ++i) {
    const std::size_t count = side_start_[i + 1] - side_start_[i];
    with[std::min(count, with.size() - 1)].push_back(static_cast<std::uint8_t>(i - first));
  }
  auto to = by_count_.begin() + static_cast<std::ptrdiff_t>(first);
  for (const auto& grains : with) to = std::copy(grains.begin(), grains.end(), to);
}

// Owned grains whose chunks are the share's.
std::pair<std::ptrdiff_t, std::ptrdiff_t> PairContacts::grains_of(std::size_t share) const {
  const auto grain = [&](std::size_t chunk) {
    return static_cast<std::ptrdiff_t>(std::min(chunk * kChunk, owned_));
  };
  return {grain(plan_.shares[share].first), grain(plan_.shares[share].last)};
}

}  // namespace grouser
