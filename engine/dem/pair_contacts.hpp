// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "engine/core/aligned.hpp"
#include "engine/core/particle.hpp"
#include "engine/core/state_io.hpp"
#include "engine/core/threads.hpp"
#include "engine/dem/activity.hpp"
#include "engine/dem/history_view.hpp"
#include "engine/dem/laws/table.hpp"
#include "engine/dem/pair_histories.hpp"
#include "engine/dem/pair_slots.hpp"
#include "engine/dem/sweep_plan.hpp"

namespace grouser {

class PairSearch;

/// Contacts between grains: neighbour list, contact histories, forces.
///
/// Each pair is evaluated once per rank that owns one of its grains, oriented from the higher to
/// the lower id, and each grain adds its pair forces in the order of partner ids. So forces do not
/// depend, to the last bit, on the order of particles in memory, on ranks, on threads, on the
/// skin or on when a list was made.
///
/// Two lists: all pairs that may touch before grains have moved half a skin, and within it the
/// slots, those pairs that may touch within the next steps. Only slots are looked at in a step,
/// and only slots have histories. Few grains are much faster than the rest; their listed pairs
/// always have slots, so that the rest's slots need not reach as far as they do.
class PairContacts {
 public:
  PairContacts(ContactLaw law, RollingLaw rolling, Threads threads);

  void set_laws(ContactLaw law, RollingLaw rolling);  ///< of the same kinds; histories stay

  /// Keeps a history for the next build, under the owned grain `grain`; a pair of two owned grains
  /// may be kept under either or both. @param values history_width() numbers
  void keep(std::uint32_t grain, std::int64_t partner, const double* values) {
    kept_.add(grain, partner, values);
  }
  std::size_t history_width() const { return kept_.width(); }

  /// Adds to `out` the histories of all touching pairs with a grain for which is_wanted, under
  /// that grain. @param particles as of the last build
  void histories_of(const std::vector<Particle>& particles, const std::vector<bool>& is_wanted,
                    PairHistories& out) const;

  /// Forgets all lists and histories.
  void forget();

  static constexpr std::uint32_t kGone = 0xFFFFFFFFu;
  /// Keeps all histories for the next build under the new numbers of the owned grains and forgets
  /// the lists. @param number of each grain owned till now, or kGone
  void renumber(const std::vector<Particle>& particles, const std::vector<std::uint32_t>& number);

  /// Makes both lists with the histories that were kept.
  /// @param particles owned grains first, then ghosts
  /// @param skin      pairs closer than the sum of radii + skin are listed [m]
  void build(const std::vector<Particle>& particles, std::size_t owned, double skin);

  /// A few neighbouring owned grains first ... last-1 whose pair forces are complete.
  struct Ready {
    std::size_t share;  ///< of the threads; tells apart what runs at the same time
    std::size_t first;
    std::size_t last;
    double* loads;  ///< kGrainLoad numbers a grain [N, N m], which may be written to
  };
  /// Takes them over. No other grain needs their positions any more in this step, so they may be
  /// moved. Called by several threads at a time, in no particular order.
  using Finish = std::function<void(const Ready&)>;

  /// Before a sweep with an activity that is on: brings the slots up to date and finds which grains
  /// are lit and which slots are wanted. Ghosts must have come.
  /// @param struck grains that may touch a body that moves
  /// @param is_new whether they, or those who sleep, are others than at the last time
  void watch(const std::vector<Particle>& particles, const std::vector<std::uint32_t>& struck,
             bool is_new, Activity& activity);

  /// Evaluates all contacts and hands over all owned grains. With an activity that is on: only what
  /// watch() found, and only the chunks with a grain that is lit.
  /// @param fetch_ghosts called once, on the first thread, before a ghost is looked at: as late as
  ///                     the order of grains allows, with one thread
  /// @return largest overlap over the smaller radius of the pair [1]
  double sweep(const std::vector<Particle>& particles, double time_step, const Finish& finish,
               const std::function<void()>& fetch_ghosts, Activity& activity);

  /// Whether a grain was much faster than the mean when the slots were made.
  bool is_fast(std::size_t grain) const { return is_fast_[grain] != 0; }
  /// Whether one of Pack::kLanes grains from this one on was.
  bool has_fast(std::size_t grain) const {
    constexpr std::array<std::uint8_t, Pack::kLanes> kNone{};
    return std::memcmp(&is_fast_[grain], kNone.data(), kNone.size()) != 0;
  }

  /// Pairs of an owned grain that are looked at in a step.
  std::size_t slots_of(std::size_t grain) const {
    return side_start_[grain + 1] - side_start_[grain];
  }

  /// Tells how fast grains were in the last step, on all ranks [m s-1]: the fastest of those that
  /// are not is_fast, and the mean over all grains of |vx| + |vy| + |vz|.
  void note_speeds(double slow, double mean, double time_step);

  /// Calls visit(lower, higher, store) for each contact that touched in the last sweep and whose
  /// lower id is owned; both are numbers of grains. After a sweep only.
  template <class Visit>
  void each_store(const std::vector<Particle>& particles, const Visit& visit) const;

  /// Calls visit(grain, partner id, values) for each touching contact whose lower id is owned.
  template <class Visit>
  void each_history(const std::vector<Particle>& particles, const Visit& visit) const;
  std::vector<StateField> history_fields() const;

  /// Contacts that touch, each counted on the rank that owns its lower id.
  std::int64_t count() const;

 private:
  // Neighbouring grains with what is listed under them: one bucket of PairHistories.
  struct Block {
    explicit Block(std::size_t history_width) : slots(history_width) {}
    std::vector<std::uint32_t> start;    // of each grain's pairs in `partner`
    std::vector<std::uint32_t> partner;  // the second grain of each pair
    PairSlots slots;                     // in the order of pairs
    std::vector<std::uint32_t> chunk_end;
  };
  static constexpr std::size_t kBlock = PairHistories::kBucket;
  static constexpr std::size_t kChunk = SweepPlan::kChunk;
  static constexpr std::size_t kChunksOfBlock = kBlock / kChunk;
  // What a thread works with.
  struct alignas(64) Desk {
    explicit Desk(std::size_t history_width) : slots(history_width) {}
    PairSlots slots;           // of a block while it is made
    LineVector<double> loads;  // of the chunk that is being added up
    double largest = 0.0;
    std::vector<double> held;  // histories of a pack, of which some stay as they are
  };
  // A pack of which some slots are wanted; bits are lanes.
  struct WatchedPack {
    std::uint32_t slot;   // of its block
    std::uint8_t frozen;  // both grains sleep
    bool is_awake;        // one of the grains is; else wanted only when grains may wake
  };
  // What there is to do for a chunk: nothing, the packs that are watched, all.
  enum class Light : std::uint8_t { kDark, kMixed, kBright };

  std::size_t last_of(std::size_t block) const;
  // Slots of a chunk in its block.
  std::size_t first_slot(std::size_t chunk) const {
    const std::size_t at = chunk % kChunksOfBlock;
    return at == 0 ? 0 : blocks_[chunk / kChunksOfBlock].chunk_end[at - 1];
  }
  std::size_t last_slot(std::size_t chunk) const {
    return blocks_[chunk / kChunksOfBlock].chunk_end[chunk % kChunksOfBlock];
  }
  // Two grains may have come closer by twice the way of one; a hair more for rounding.
  bool needs_slots() const { return 2.0 * travel_ * (1.0 + 1e-9) >= gap_; }
  std::pair<std::ptrdiff_t, std::ptrdiff_t> grains_of(std::size_t share) const;
  const double* kept(const std::vector<Particle>& particles, std::size_t i, std::size_t j) const;
  void start_plan();
  void list_pairs(const PairSearch& search, std::size_t block,
                  std::vector<std::uint32_t>& partners);
  void mark_fast(const std::vector<Particle>& particles);
  bool needs_slot(const std::vector<Particle>& particles, std::size_t i, std::size_t j) const;
  template <class History>
  void make_slots(const std::vector<Particle>& particles, std::size_t block, PairSlots& scratch,
                  const History& of);
  void refresh(const std::vector<Particle>& particles);
  void refresh(const std::vector<Particle>& particles, std::size_t block, PairSlots& scratch);
  void plan_sweep(const std::vector<Particle>& particles);
  template <class Visit>
  void each_side(std::size_t share, const Visit& visit) const;
  void order_sides(const std::vector<Particle>& particles, std::size_t share, std::uint32_t begin);
  void order_by_count(std::size_t chunk);

  template <class Law, class Rolling>
  double sweep(const Law& law, const Rolling& rolling, const std::vector<Particle>& particles,
               double time_step, const Finish& finish, const std::function<void()>& fetch_ghosts,
               Activity& activity);
  void watch_chunk(std::size_t chunk, const Activity& activity);
  template <class Law, class Rolling>
  void evaluate_watched(const Law& law, const Rolling& rolling, const double* grains,
                        std::size_t chunk, double time_step, Activity& activity, Desk& desk);
  double* result_of(std::size_t chunk, std::size_t slot);
  template <class Law, class Rolling>
  void evaluate(const Law& law, const Rolling& rolling, const double* grains, std::size_t chunk,
                double time_step, Pack& largest);
  void hand_over(std::size_t share, std::size_t chunk, const Finish& finish,
                 const Activity& activity);
  void add_up(std::size_t first, std::size_t last, double* loads, const Activity* wanted) const;

  ContactLaw law_;
  RollingLaw rolling_;
  Threads threads_;
  std::size_t owned_ = 0;
  double skin_ = 0.0;
  std::vector<Block> blocks_;
  PairHistories kept_;
  SweepPlan plan_;
  std::vector<Desk> desks_;
  std::vector<std::uint8_t> is_fast_;
  std::vector<std::uint32_t> side_start_;  // of each owned grain's slots by partner id
  std::vector<std::uint32_t> sides_;       // twice the result's place, + 1 under the higher id
  std::vector<std::uint8_t> by_count_;     // grains of each chunk by their number of slots
  double gap_ = 0.0;                       // slow pairs closer than this have slots [m]
  double travel_ = 0.0;                    // bound of a slow grain's way since then [m]
  double slow_speed_ = 0.0;
  double fast_speed_ = 0.0;  // from here on a grain is fast
  double time_step_ = 0.0;
  // Of each chunk, with an activity that is on:
  std::vector<Light> lights_;
  std::vector<std::vector<WatchedPack>> watched_;
  bool has_new_slots_ = true;
  LineVector<double> results_;  // what each slot does in this step, where the plan says
};

template <class Visit>
void PairContacts::each_store(const std::vector<Particle>& particles, const Visit& visit) const {
  std::vector<double> values(history_width());
  for (const Block& block : blocks_)
    for (std::size_t slot = 0; slot < block.slots.size(); ++slot) {
      const std::uint32_t lower = block.slots.lower(slot);
      const std::uint32_t higher = block.slots.higher(slot);
      if (!block.slots.is_touching(slot) || lower >= owned_) continue;
      block.slots.history_of(slot, values.data());
      const double a = particles[lower].radius;
      const double b = particles[higher].radius;
      visit(lower, higher, store_of(law_, rolling_, values.data(), a * b / (a + b)));
    }
}

template <class Visit>
void PairContacts::each_history(const std::vector<Particle>& particles, const Visit& visit) const {
  // Before the first build histories wait under both grains.
  kept_.each([&](std::uint32_t grain, std::int64_t partner, const double* values) {
    if (particles[grain].id < partner) visit(grain, partner, values);
  });
  std::vector<double> values(history_width());
  for (const Block& block : blocks_)
    for (std::size_t slot = 0; slot < block.slots.size(); ++slot) {
      const std::uint32_t lower = block.slots.lower(slot);
      if (!block.slots.is_touching(slot) || lower >= owned_) continue;
      block.slots.history_of(slot, values.data());
      visit(lower, particles[block.slots.higher(slot)].id, values.data());
    }
}

}  // namespace grouser
