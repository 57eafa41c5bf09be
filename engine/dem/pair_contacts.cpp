// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/pair_contacts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "base/check.hpp"
#include "engine/dem/pair_pack.hpp"
#include "engine/dem/pair_search.hpp"

namespace grouser {
namespace {

constexpr std::size_t kLanes = Pack::kLanes;
constexpr std::size_t kBlock = PairHistories::kBucket;

// Grains whose contacts are evaluated before their forces are added up; the results in between
// stay in the nearest caches.
constexpr std::size_t kChunk = 256;
static_assert(kBlock % kChunk == 0);

// Packs whose geometry is found before their laws are evaluated.
constexpr std::size_t kBatch = 8;

// Pairs between fetching a grain and using it.
constexpr std::size_t kAhead = 64;

// Steps that the slots should last at the present speed, within these shares of the skin.
constexpr double kSlotSteps = 24.0;
constexpr double kLeastGap = 0.04;
constexpr double kLargestGap = 0.5;

// A grain is fast from this many times the mean speed on.
constexpr double kFast = 4.0;

}  // namespace

PairContacts::PairContacts(ContactLaw law, RollingLaw rolling)
    : law_(law),
      rolling_(rolling),
      kept_(grouser::history_width(law, rolling)),
      scratch_(kept_.width()),
      fast_speed_(std::numeric_limits<double>::infinity()),
      forces_(kChunk * 4),
      moments_(kChunk * 4) {}

void PairContacts::set_laws(ContactLaw law, RollingLaw rolling) {
  GROUSER_CHECK(law.index() == law_.index() && rolling.index() == rolling_.index());
  law_ = law;
  rolling_ = rolling;
}

void PairContacts::forget() {
  blocks_.clear();
  kept_.clear();
}

std::size_t PairContacts::last_of(std::size_t block) const {
  return std::min((block + 1) * kBlock, owned_);
}

void PairContacts::histories_of(const std::vector<Particle>& particles,
                                const std::vector<bool>& is_wanted, PairHistories& out) const {
  kept_.each([&](std::uint32_t grain, std::int64_t partner, const double* values) {
    if (is_wanted[grain]) out.add(grain, partner, values);
  });
  std::vector<double> values(history_width());
  for (const Block& block : blocks_)
    for (std::size_t slot = 0; slot < block.slots.size(); ++slot) {
      if (!block.slots.is_touching(slot)) continue;
      const std::uint32_t lower = block.slots.lower(slot);
      const std::uint32_t higher = block.slots.higher(slot);
      const bool wants_lower = lower < owned_ && is_wanted[lower];
      const bool wants_higher = higher < owned_ && is_wanted[higher];
      if (!wants_lower && !wants_higher) continue;
      block.slots.history_of(slot, values.data());
      if (wants_lower) out.add(lower, particles[higher].id, values.data());
      if (wants_higher) out.add(higher, particles[lower].id, values.data());
    }
}

void PairContacts::renumber(const std::vector<Particle>& particles,
                            const std::vector<std::uint32_t>& number) {
  PairHistories next(history_width());
  kept_.drain([&](std::uint32_t grain, std::int64_t partner, const double* values) {
    if (number[grain] != kGone) next.add(number[grain], partner, values);
  });
  std::vector<double> values(history_width());
  // What the lists hold beside histories would stand beside the copies.
  for (Block& block : blocks_) {
    block.slots.free_shapes();
    std::vector<std::uint32_t>().swap(block.partner);
  }
  for (Block& block : blocks_) {
    for (std::size_t slot = 0; slot < block.slots.size(); ++slot) {
      if (!block.slots.is_touching(slot)) continue;
      std::uint32_t own = block.slots.lower(slot);
      std::uint32_t other = block.slots.higher(slot);
      const auto is_here = [&](std::uint32_t i) { return i < owned_ && number[i] != kGone; };
      if (!is_here(own) || (is_here(other) && number[other] < number[own])) std::swap(own, other);
      if (!is_here(own)) continue;
      block.slots.history_of(slot, values.data());
      next.add(number[own], particles[other].id, values.data());
    }
    block = Block(history_width());
  }
  blocks_.clear();
  kept_ = std::move(next);
}

void PairContacts::build(const std::vector<Particle>& particles, std::size_t owned, double skin) {
  // Places of grains are held in 32 bits.
  GROUSER_CHECK(particles.size() <
                std::numeric_limits<std::uint32_t>::max() / sizeof(Particle) * sizeof(double));
  owned_ = owned;
  skin_ = skin;
  kept_.sort();
  mark_fast(particles);
  blocks_.clear();
  {
    const PairSearch search(particles, skin);
    std::vector<std::uint32_t> partners;
    for (std::size_t b = 0; b * kBlock < owned_; ++b) {
      Block& block = blocks_.emplace_back(history_width());
      partners.clear();
      block.start.assign(1, 0);
      for (std::size_t i = b * kBlock; i < last_of(b); ++i) {
        search.list_behind(i, partners);
        block.start.push_back(static_cast<std::uint32_t>(partners.size()));
      }
      block.partner.assign(partners.begin(), partners.end());
      make_slots(particles, b, [&](std::size_t i, std::size_t j) { return kept(particles, i, j); });
      // Pairs are listed under the grain in front, so no later block asks for these.
      kept_.free_bucket(b);
    }
  }
  kept_.clear();
  order_sides(particles);
}

const double* PairContacts::kept(const std::vector<Particle>& particles, std::size_t i,
                                 std::size_t j) const {
  const double* const history = kept_.find(static_cast<std::uint32_t>(i), particles[j].id);
  if (history != nullptr || j >= owned_) return history;
  return kept_.find(static_cast<std::uint32_t>(j), particles[i].id);
}

void PairContacts::note_speeds(double slow, double mean, double time_step) {
  travel_ += slow * time_step;
  slow_speed_ = slow;
  fast_speed_ = kFast * mean;
  time_step_ = time_step;
}

// The speeds are those of the owner's last step on every rank, so a grain and its ghosts agree.
void PairContacts::mark_fast(const std::vector<Particle>& particles) {
  is_fast_.resize(particles.size());
  const double limit2 = fast_speed_ * fast_speed_;
  for (std::size_t i = 0; i < particles.size(); ++i)
    is_fast_[i] = norm2(particles[i].velocity) > limit2 ? 1 : 0;
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
                              const History& of) {
  Block& block = blocks_[b];
  block.chunk_end.clear();
  scratch_.clear();
  for (std::size_t i = b * kBlock; i < last_of(b); ++i) {
    const std::size_t at = i - b * kBlock;
    for (std::uint32_t k = block.start[at]; k < block.start[at + 1]; ++k) {
      const std::size_t j = block.partner[k];
      if (needs_slot(particles, i, j)) scratch_.add(particles, i, j, of(i, j));
    }
    if ((i + 1) % kChunk == 0 || i + 1 == last_of(b)) {
      scratch_.pad();
      block.chunk_end.push_back(static_cast<std::uint32_t>(scratch_.size()));
    }
  }
  block.slots = scratch_;
}

void PairContacts::refresh(const std::vector<Particle>& particles) {
  mark_fast(particles);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    // Old slots stand in the order of the list too, so one pass finds them.
    const PairSlots old = std::move(blocks_[b].slots);
    blocks_[b].slots = PairSlots(history_width());
    std::size_t at = 0;
    std::vector<double> values(history_width());
    make_slots(particles, b, [&](std::size_t i, std::size_t j) -> const double* {
      const auto first = [&](std::size_t slot) {
        return std::min(old.lower(slot), old.higher(slot));
      };
      const auto second = [&](std::size_t slot) {
        return std::max(old.lower(slot), old.higher(slot));
      };
      while (at < old.size() && (old.is_padding(at) || first(at) < i)) ++at;
      for (std::size_t slot = at; slot < old.size() && first(slot) == i; ++slot) {
        if (second(slot) != j || !old.is_touching(slot)) continue;
        old.history_of(slot, values.data());
        return values.data();
      }
      return nullptr;
    });
  }
  order_sides(particles);
}

// Lists each grain's slots by partner id, and finds how far back an adding grain looks.
void PairContacts::order_sides(const std::vector<Particle>& particles) {
  std::size_t slots = 0;
  for (Block& block : blocks_) {
    block.first_slot = static_cast<std::uint32_t>(slots);
    slots += block.slots.size();
  }
  // A slot and its side share 32 bits.
  GROUSER_CHECK(slots < std::numeric_limits<std::int32_t>::max());
  const auto each_side = [&](const auto& visit) {
    for (const Block& block : blocks_)
      for (std::uint32_t slot = 0; slot < block.slots.size(); ++slot) {
        if (block.slots.is_padding(slot)) continue;
        const std::uint32_t lower = block.slots.lower(slot);
        const std::uint32_t higher = block.slots.higher(slot);
        const std::uint32_t side = 2 * (block.first_slot + slot);
        if (lower < owned_) visit(lower, higher, side);
        if (higher < owned_) visit(higher, lower, side + 1);
      }
  };
  side_start_.assign(owned_ + 1, 0);
  each_side([&](std::uint32_t own, std::uint32_t, std::uint32_t) { ++side_start_[own + 1]; });
  for (std::size_t i = 1; i < side_start_.size(); ++i) side_start_[i] += side_start_[i - 1];
  sides_.resize(side_start_.back());
  std::vector<std::uint32_t> next(side_start_.begin(), side_start_.end() - 1);
  std::vector<std::uint32_t> partner(sides_.size());
  each_side([&](std::uint32_t own, std::uint32_t other, std::uint32_t side) {
    // Insertion sort: a grain has about five slots.
    std::uint32_t at = next[own]++;
    for (; at > side_start_[own] && particles[partner[at - 1]].id > particles[other].id; --at) {
      partner[at] = partner[at - 1];
      sides_[at] = sides_[at - 1];
    }
    partner[at] = other;
    sides_[at] = side;
  });

  std::uint32_t window = kLanes;
  by_count_.resize(owned_);
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    for (std::size_t first = b * kBlock; first < last_of(b); first += kChunk) {
      const std::size_t last = std::min(first + kChunk, owned_);
      const std::uint32_t end =
          blocks_[b].first_slot + blocks_[b].chunk_end[(first - b * kBlock) / kChunk];
      std::array<std::vector<std::uint8_t>, 16> with;
      for (std::size_t i = first; i < last; ++i) {
        for (std::uint32_t at = side_start_[i]; at < side_start_[i + 1]; ++at)
          window = std::max(window, end - (sides_[at] >> 1));
        const std::size_t count = side_start_[i + 1] - side_start_[i];
        with[std::min(count, with.size() - 1)].push_back(static_cast<std::uint8_t>(i - first));
      }
      auto to = by_count_.begin() + static_cast<std::ptrdiff_t>(first);
      for (const auto& grains : with) to = std::copy(grains.begin(), grains.end(), to);
    }
  const std::uint32_t capacity = std::bit_ceil(window);
  result_mask_ = capacity - 1;
  if (results_.size() < capacity * kPairResult) results_.resize(capacity * kPairResult);
}

// Asks for the second grains of a pack that is evaluated soon; the first ones follow one another.
inline void fetch_ahead(const double* grains, const PairSlots& slots, std::size_t slot) {
  if (slot + kLanes > slots.size()) return;
  const std::uint32_t* const lower = slots.lower_places(slot);
  const std::uint32_t* const higher = slots.higher_places(slot);
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double* const grain = grains + std::max(lower[k], higher[k]);
    __builtin_prefetch(grain);
    __builtin_prefetch(grain + 11);
  }
}

template <class Law, class Rolling>
double PairContacts::sweep(const Law& law, const Rolling& rolling,
                           const std::vector<Particle>& particles, double time_step,
                           const Finish& finish) {
  const double* const grains = particles.empty() ? nullptr : &particles[0].position.x;
  std::array<PairPack, kBatch> packs;
  Pack largest;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    PairSlots& slots = blocks_[b].slots;
    std::size_t slot = 0;
    for (std::size_t chunk = 0; chunk < blocks_[b].chunk_end.size(); ++chunk) {
      const std::size_t end = blocks_[b].chunk_end[chunk];
      while (slot < end) {
        const std::size_t count = std::min(kBatch, (end - slot) / kLanes);
        for (std::size_t k = 0; k < count; ++k) {
          fetch_ahead(grains, slots, slot + k * kLanes + kAhead);
          packs[k].approach(grains, slots, slot + k * kLanes);
        }
        for (std::size_t k = 0; k < count; ++k, slot += kLanes) {
          const PairPack& pack = packs[k];
          const std::size_t place = (blocks_[b].first_slot + slot) & result_mask_;
          pack.act(law, rolling, time_step, slots.histories(slot), &results_[place * kPairResult]);
          slots.touching(slot) = static_cast<std::uint8_t>(pack.touches.to_unsigned());
          // A new largest share is rare: the division waits for it.
          const PackMask is_larger = pack.touches & (pack.at.overlap > largest * pack.smaller);
          if (any(is_larger)) largest = select(is_larger, pack.at.overlap / pack.smaller, largest);
        }
      }
      const std::size_t first = b * kBlock + chunk * kChunk;
      const std::size_t last = std::min(first + kChunk, owned_);
      add_up(first, last);
      finish(first, last, forces_.data(), moments_.data());
    }
  }
  double result = 0.0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) result = std::max(result, largest[lane]);
  return result;
}

// Forces of a chunk's grains: all their slots have been evaluated by now. Grains with equally many
// slots follow one another, which the processor foresees.
void PairContacts::add_up(std::size_t first, std::size_t last) {
  // Turns the force on the lower id into that on the higher: only the sign bits differ.
  alignas(32) static constexpr double kSign[8] = {0.0, 0.0, 0.0, 0.0, -0.0, -0.0, -0.0, -0.0};
  for (std::size_t k = first; k < last; ++k) {
    const std::size_t local = by_count_[k];
    Quad sum{};
    Quad turn{};
    for (std::uint32_t at = side_start_[first + local]; at < side_start_[first + local + 1]; ++at) {
      const std::uint32_t side = sides_[at];
      const std::uint32_t is_higher = side & 1u;
      const double* const result = &results_[(side >> 1 & result_mask_) * kPairResult];
      sum += flip_signs(load_quad(result), load_quad(kSign + 4 * is_higher));
      turn += load_quad(result + 4 + 4 * is_higher);
    }
    store_quad(&forces_[4 * local], sum);
    store_quad(&moments_[4 * local], turn);
  }
}

double PairContacts::sweep(const std::vector<Particle>& particles, double time_step,
                           const Finish& finish) {
  // Two grains may have come closer by twice the way of one; a hair more for rounding.
  if (2.0 * travel_ * (1.0 + 1e-9) >= gap_) refresh(particles);
  return std::visit(
      [&](const auto& law, const auto& rolling) {
        return sweep(law, rolling, particles, time_step, finish);
      },
      law_, rolling_);
}

std::vector<StateField> PairContacts::history_fields() const {
  std::vector<StateField> fields = std::visit(
      [](const auto& law) { return std::decay_t<decltype(law)>::history_fields(); }, law_);
  const std::vector<StateField> more = std::visit(
      [](const auto& law) { return std::decay_t<decltype(law)>::history_fields(); }, rolling_);
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

std::int64_t PairContacts::count() const {
  std::int64_t total = 0;
  for (const Block& block : blocks_)
    for (std::size_t slot = 0; slot < block.slots.size(); ++slot)
      if (block.slots.is_touching(slot) && block.slots.lower(slot) < owned_) ++total;
  return total;
}

}  // namespace grouser
