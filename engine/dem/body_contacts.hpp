// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/core/aligned.hpp"
#include "engine/core/exact_sum.hpp"
#include "engine/core/particle.hpp"
#include "engine/core/state_io.hpp"
#include "engine/core/threads.hpp"
#include "engine/dem/activity.hpp"
#include "engine/dem/body.hpp"
#include "engine/dem/history_view.hpp"
#include "engine/dem/laws/table.hpp"
#include "engine/dem/pair_pack.hpp"

namespace grouser {

/// Force [N] and moment about the body's axle [N m] of the grains on a body; sums that do not
/// depend on ranks or threads.
struct BodyLoad {
  ExactSum force_x, force_y, force_z;
  ExactSum force_moment_y;  ///< of the contact forces: force tangential to the circle x distance
  ExactSum couple_y;        ///< rolling resistance of the grains, which has no force

  double moment_y() const { return force_moment_y.value() + couple_y.value(); }
  void add(const BodyLoad& other);
};

/// Contacts of owned grains with one body, under the same laws as grain pairs. A grain may touch a
/// body in several places (a corner); each touch has its own history, which follows the grain from
/// facet to neighbouring facet.
///
/// Each thread looks after a part of the grains near the body, neighbours in memory, and all that
/// belongs to them.
class BodyContacts {
 public:
  BodyContacts(ContactLaw law, RollingLaw rolling, Threads threads);

  /// Keeps a touch of the owned grain `grain` for the next build. @param values history_width()
  /// numbers
  void keep(std::uint32_t grain, int facet, const double* values);

  /// Forgets all touches.
  void forget();

  /// Gives the touches' grains their new numbers. @param number of each grain owned till now, or
  /// PairContacts::kGone
  void renumber(const std::vector<std::uint32_t>& number);

  /// Looks for grains near the body.
  /// @param skin what grains near the body are looked for beyond their radius [m]
  void build(const std::vector<Particle>& particles, std::size_t owned, const Body& body,
             double skin);

  /// Looks again for grains that come within the search's reach of the body; only they are looked
  /// at in the steps that follow. Histories stay. Local.
  void find_near(const std::vector<Particle>& particles, std::size_t owned, const Body& body);

  /// Tells that no grain has moved by more than `distance` [m] in a step.
  void note_travel(double distance) { travel_ += distance; }

  /// Evaluates all touches; adds the opposite to `load`. Those of a sleeping grain with a body at
  /// rest stay as they are and add nothing, even where the forces on that grain are wanted.
  /// @return largest overlap over grain radius [1]
  double sweep(const std::vector<Particle>& particles, const Body& body, double time_step,
               Activity& activity, BodyLoad& load);

  /// Calls visit(grain, push) for what the last sweep did to the grains first ... last-1, grain by
  /// grain: force [N] and moment about the grain's centre [N m], kGrainLoad numbers.
  template <class Visit>
  void each_push(std::size_t first, std::size_t last, const Visit& visit) const {
    for (const Part& part : parts_) {
      const auto begin = part.acting.begin();
      for (auto at = first_of(part.acting, first); at != part.acting.end() && at->particle < last;
           ++at)
        visit(at->particle, &part.pushes[static_cast<std::size_t>(at - begin) * kGrainLoad]);
    }
  }

  /// Owned grains that may touch before the next find_near.
  const std::vector<std::uint32_t>& near() const { return near_; }

  std::size_t count() const;
  std::size_t history_width() const { return history_width_; }

  /// Calls visit(grain, facet, history) for the touches of the grains first ... last-1, grain by
  /// grain.
  template <class Visit>
  void each_touch(std::size_t first, std::size_t last, const Visit& visit) const {
    const auto each_of = [&](const Touches& touches) {
      for (auto at = first_of(touches.at, first); at != touches.at.end() && at->particle < last;
           ++at)
        visit(at->particle, at->facet,
              touches.history.data() +
                  static_cast<std::size_t>(at - touches.at.begin()) * history_width_);
    };
    each_of(kept_);
    for (const Part& part : parts_) each_of(part.touches);
  }

  /// Calls visit(grain, store) for what each touch holds. After a sweep only.
  template <class Visit>
  void each_store(const std::vector<Particle>& particles, const Visit& visit) const {
    each_touch(0, particles.size(), [&](std::uint32_t grain, int, const double* history) {
      visit(grain, store_of(law_, rolling_, history, particles[grain].radius));
    });
  }

 private:
  struct Touch {
    std::uint32_t particle = 0;
    int facet = 0;
  };
  // By grain, then facet.
  struct Touches {
    std::vector<Touch> at;
    std::vector<double> history;  // history_width_ numbers each
    void clear() {
      at.clear();
      history.clear();
    }
  };
  // A grain that may touch before grains or body have come closer by gap_, with the number of
  // facets it may touch.
  struct Close {
    std::uint32_t particle;
    std::uint32_t facets;
  };
  // A touch whose force on the grain is wanted in this step, and its place in Part::next.
  struct Acting {
    std::uint32_t particle;
    std::size_t place;  // kFrozen: the grain sleeps, nothing is remembered
  };
  static constexpr std::size_t kFrozen = static_cast<std::size_t>(-1);
  // The grains near_[first] ... near_[last-1] and what belongs to them.
  struct alignas(64) Part {
    std::size_t first = 0;
    std::size_t last = 0;
    std::vector<Close> close;
    std::vector<int> facets;  // of one close grain after the other
    Touches touches;          // of the last step
    Touches next;
    std::vector<Acting> acting;
    std::vector<double> acting_history;  // of each, history_width_ numbers
    LineVector<double> nearest;          // of each: the body's point [m], and how far it is [m]
    LineVector<double> pushes;           // of each: kGrainLoad numbers
    BodyLoad load;
    double largest = 0.0;  // overlap over grain radius
    // Of the grain that is being looked at.
    std::vector<MeshTouch> now;
    std::vector<double> histories;
  };

  // The first of the records, which are ordered by grain, that belongs to a grain from `grain` on.
  template <class Record>
  static typename std::vector<Record>::const_iterator first_of(const std::vector<Record>& records,
                                                               std::size_t grain) {
    return std::lower_bound(
        records.begin(), records.end(), grain,
        [](const Record& record, std::size_t wanted) { return record.particle < wanted; });
  }

  void collect();
  void look(const std::vector<Particle>& particles, std::size_t owned, const Body& body);
  void find_close(const std::vector<Particle>& particles, const Body& body, Part& part) const;
  void find_touches(const std::vector<Particle>& particles, const Body& body, Activity& activity,
                    Part& part) const;
  void carry_over(Part& part, std::size_t first, std::size_t last) const;
  template <class Law, class Rolling>
  void act(const Law& law, const Rolling& rolling, const std::vector<Particle>& particles,
           const Body& body, double time_step, Part& part) const;
  /// Finds the histories of the touches `now` among those first ... last-1 of the same grain in the
  /// step before.
  void inherit(Part& part, std::size_t first, std::size_t last, const MeshSearch& search) const;

  ContactLaw law_;
  RollingLaw rolling_;
  Threads threads_;
  std::size_t history_width_ = 0;
  double skin_ = 0.0;
  std::vector<std::uint32_t> near_;
  std::vector<Part> parts_;
  Touches kept_;         // while no part holds them
  double gap_ = 0.0;     // [m]; 0 = not known
  double travel_ = 0.0;  // bound of how much closer grains and body have come since [m]
};

}  // namespace grouser
