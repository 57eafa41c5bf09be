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

// Packs whose geometry is found before their laws are evaluated.
constexpr std::size_t kBatch = 8;

// Pairs between fetching a grain and using it.
constexpr std::size_t kAhead = 64;

// A grain is fast from this many times the mean speed on.
constexpr double kFast = 4.0;

}  // namespace

PairContacts::PairContacts(ContactLaw law, RollingLaw rolling, Threads threads)
    : law_(law),
      rolling_(rolling),
      threads_(threads),
      kept_(grouser::history_width(law, rolling)),
      desks_(threads.count(), Desk(kept_.width())),
      fast_speed_(std::numeric_limits<double>::infinity()) {
  for (Desk& desk : desks_) desk.loads.resize(kChunk * kGrainLoad);
}

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

void PairContacts::note_speeds(double slow, double mean, double time_step) {
  travel_ += slow * time_step;
  slow_speed_ = slow;
  fast_speed_ = kFast * mean;
  time_step_ = time_step;
}

// Asks for the second grains of a pack that is evaluated soon; the first ones follow one another.
// Called, it would be taken for a function without effect and left out.
[[gnu::always_inline]] inline void fetch_ahead(const double* grains, const PairSlots& slots,
                                               std::size_t slot) {
  if (slot + kLanes > slots.size()) return;
  const std::uint32_t* const lower = slots.lower_places(slot);
  const std::uint32_t* const higher = slots.higher_places(slot);
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double* const grain = grains + std::max(lower[k], higher[k]);
    __builtin_prefetch(grain);
    __builtin_prefetch(grain + 11);
  }
}

double* PairContacts::result_of(std::size_t chunk, std::size_t slot) {
  return &results_[(plan_.chunks[chunk].place + (slot - first_slot(chunk))) * kPairResult];
}

// Leaves in `results_` what the chunk's slots do.
template <class Law, class Rolling>
void PairContacts::evaluate(const Law& law, const Rolling& rolling, const double* grains,
                            std::size_t chunk, double time_step, Pack& largest) {
  PairSlots& slots = blocks_[chunk / kChunksOfBlock].slots;
  const std::size_t end = last_slot(chunk);
  double* result = result_of(chunk, first_slot(chunk));
  std::array<PairPack, kBatch> packs;
  for (std::size_t slot = first_slot(chunk); slot < end;) {
    const std::size_t count = std::min(kBatch, (end - slot) / kLanes);
    for (std::size_t k = 0; k < count; ++k) {
      fetch_ahead(grains, slots, slot + k * kLanes + kAhead);
      packs[k].approach(grains, slots, slot + k * kLanes);
    }
    for (std::size_t k = 0; k < count; ++k, slot += kLanes, result += kLanes * kPairResult) {
      const PairPack& pack = packs[k];
      pack.act(law, rolling, time_step, slots.histories(slot), result);
      slots.touching(slot) = static_cast<std::uint8_t>(pack.touches.to_unsigned());
      // A new largest share is rare: the division waits for it.
      const PackMask is_larger = pack.touches & (pack.at.overlap > largest * pack.smaller);
      if (any(is_larger)) largest = select(is_larger, pack.at.overlap / pack.smaller, largest);
    }
  }
}

// The same where some grains sleep or may fall asleep. What two that sleep remember stays as it is.
template <class Law, class Rolling>
void PairContacts::evaluate_watched(const Law& law, const Rolling& rolling, const double* grains,
                                    std::size_t chunk, double time_step, Activity& activity,
                                    Desk& desk) {
  PairSlots& slots = blocks_[chunk / kChunksOfBlock].slots;
  const std::size_t width = history_width();
  desk.held.resize(width * kLanes);
  for (const auto& [slot, frozen, is_awake] : watched_[chunk]) {
    if (!is_awake && !activity.may_wake()) continue;
    PairPack pack;
    pack.approach(grains, slots, slot);
    double* const histories = slots.histories(slot);
    if (frozen != 0) std::copy_n(histories, width * kLanes, desk.held.begin());
    pack.act(law, rolling, time_step, histories, result_of(chunk, slot));
    for (std::size_t lane = 0; lane < kLanes && frozen != 0; ++lane)
      for (std::size_t c = 0; c < width && (frozen >> lane & 1u) != 0; ++c)
        histories[c * kLanes + lane] = desk.held[c * kLanes + lane];
    const unsigned before = slots.touching(slot);
    const unsigned now = pack.touches.to_unsigned();
    slots.touching(slot) = static_cast<std::uint8_t>(now);
    for (unsigned bits = (before | now) & ~unsigned{frozen}; bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
      activity.note_touch(slots.lower(slot + lane), slots.higher(slot + lane));
      if ((now >> lane & 1u) != 0)
        desk.largest = std::max(desk.largest, pack.at.overlap[lane] / pack.smaller[lane]);
    }
  }
}

template <class Law, class Rolling>
double PairContacts::sweep(const Law& law, const Rolling& rolling,
                           const std::vector<Particle>& particles, double time_step,
                           const Finish& finish, const std::function<void()>& fetch_ghosts,
                           Activity& activity) {
  const auto light_of = [&](std::size_t chunk) {
    return activity.is_on() ? lights_[chunk] : Light::kBright;
  };
  const double* const grains = particles.empty() ? nullptr : &particles[0].position.x;
  const auto first = std::find_if(plan_.chunks.begin(), plan_.chunks.end(),
                                  [](const SweepPlan::Chunk& chunk) { return chunk.has_ghosts; });
  const auto first_with_ghosts = static_cast<std::size_t>(first - plan_.chunks.begin());
  const bool may_wait = threads_.count() == 1;  // else other threads are there already
  if (!may_wait) fetch_ghosts();
  threads_.run([&](std::size_t share) {
    Pack largest;
    desks_[share].largest = 0.0;
    for (std::size_t c = plan_.shares[share].first; c < plan_.shares[share].last; ++c) {
      if (may_wait && c == first_with_ghosts) fetch_ghosts();
      const Light light = light_of(c);
      if (light == Light::kDark) continue;
      if (light == Light::kMixed || activity.is_look()) {
        evaluate_watched(law, rolling, grains, c, time_step, activity, desks_[share]);
      } else {
        evaluate(law, rolling, grains, c, time_step, largest);
      }
      if (!plan_.chunks[c].is_late) hand_over(share, c, finish, activity);
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      desks_[share].largest = std::max(desks_[share].largest, largest[lane]);
  });
  if (threads_.count() > 1)
    threads_.run([&](std::size_t share) {
      for (std::size_t c = plan_.shares[share].first; c < plan_.shares[share].last; ++c)
        if (plan_.chunks[c].is_late && light_of(c) != Light::kDark)
          hand_over(share, c, finish, activity);
    });
  if (may_wait && first_with_ghosts == plan_.chunks.size()) fetch_ghosts();
  double result = 0.0;
  for (const Desk& desk : desks_) result = std::max(result, desk.largest);
  return result;
}

// All slots that act on the chunk's grains have been evaluated by now.
void PairContacts::hand_over(std::size_t share, std::size_t chunk, const Finish& finish,
                             const Activity& activity) {
  Desk& desk = desks_[share];
  const std::size_t first = chunk * kChunk;
  const std::size_t last = std::min(first + kChunk, owned_);
  const bool some = activity.is_on() && lights_[chunk] == Light::kMixed;
  add_up(first, last, desk.loads.data(), some ? &activity : nullptr);
  finish({share, first, last, desk.loads.data()});
}

// Grains with equally many slots follow one another, which the processor foresees.
// @param wanted of which grains; null: of all
void PairContacts::add_up(std::size_t first, std::size_t last, double* loads,
                          const Activity* wanted) const {
  for (std::size_t k = first; k < last; ++k) {
    const std::size_t local = by_count_[k];
    if (wanted != nullptr && !wanted->is_wanted(first + local)) continue;
    const std::uint32_t* side = &sides_[side_start_[first + local]];
    const std::uint32_t* const end = &sides_[side_start_[first + local + 1]];
    QuadPair sum;
    for (; side != end; ++side) sum.add(&results_[std::size_t{*side} * kGrainLoad]);
    sum.store(&loads[kGrainLoad * local]);
  }
}

double PairContacts::sweep(const std::vector<Particle>& particles, double time_step,
                           const Finish& finish, const std::function<void()>& fetch_ghosts,
                           Activity& activity) {
  const bool is_out = needs_slots();
  if (is_out) {
    fetch_ghosts();
    refresh(particles);
  }
  const std::function<void()> nothing = [] {};
  return std::visit(
      [&](const auto& law, const auto& rolling) {
        return sweep(law, rolling, particles, time_step, finish, is_out ? nothing : fetch_ghosts,
                     activity);
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
