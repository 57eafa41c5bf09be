// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/core/exact_sum.hpp"
#include "engine/core/particle.hpp"
#include "engine/core/state_io.hpp"

namespace grouser {

/// When grains at rest fall asleep and wake.
struct ActivityRule {
  double speed = 0.0;         ///< of the centre, and of the surface by spin; slower is slow [m s-1]
  double imbalance = 0.0;     ///< share of the weight that wakes; half of it keeps awake [1]
  std::int64_t interval = 0;  ///< steps between looks at who falls asleep; 0 = nobody ever sleeps
};

/// A grain that sleeps has velocity.z = -0.0, a number that no step leaves behind: a sum is -0.0
/// only when both its terms are. So every copy of a grain tells, be it a ghost, in a message or in
/// a checkpoint. Local.
inline bool is_asleep(const Particle& p) {
  return p.velocity.z == 0.0 && std::signbit(p.velocity.z);
}

/// Who sleeps, and what is found out about it in a step. docs/physics/activity.md.
///
/// A sleeping grain does not move, and its contacts with sleeping grains and with bodies at rest
/// stay as they are. Every kWakeInterval steps, when it touches a grain that is awake or a body
/// that moves, or has lost such a touch since, the forces on it are added up; when they and its
/// weight are out of balance by more than a share of that weight it wakes, and moves in the same
/// step. Every `interval` steps those grains fall asleep that are slow and nearly in balance and
/// touch slow grains and no moving body. All of it follows from what every rank knows of its grains
/// and ghosts before the step, so who sleeps does not depend on ranks, threads or lists. Neglected:
/// what an unbalanced force of up to that share of the weight, or a speed below the limit, would
/// have moved. The kinetic energy of a grain that falls asleep is lost and accounted for.
class Activity {
 public:
  /// Steps, a few of the 8 or more of the shortest collision.
  static constexpr std::int64_t kWakeInterval = 4;

  Activity(const ActivityRule& rule, double gravity) : rule_(rule), gravity_(gravity) {}

  bool is_on() const { return rule_.interval > 0; }

  /// Looks who sleeps now. @param are_new the grains are others than in the step before, or in
  /// another order. Local.
  void begin_step(const std::vector<Particle>& particles, std::size_t owned, bool are_new);
  bool has_changed() const { return has_changed_; }  ///< who sleeps, since the step before
  bool is_look() const { return is_look_; }    ///< whether grains may fall asleep in this step
  bool may_wake() const { return may_wake_; }  ///< whether owned grains may wake in this step

  bool is_asleep(std::size_t grain) const { return asleep_[grain] != 0; }

  /// Whether a grain is awake, or may touch one that is or a body that moves, or has lost such a
  /// touch and not been tested since.
  bool is_lit(std::size_t grain) const { return lit_[grain] != 0; }
  /// Whether the forces on an owned grain are needed in this step.
  bool is_wanted(std::size_t grain) const {
    return asleep_[grain] == 0 || (may_wake_ && lit_[grain] != 0);
  }
  /// Lights those that are lit by themselves and puts out the rest. Local.
  void light_alone(const std::vector<Particle>& particles);
  /// By any thread. Local.
  void light(std::size_t grain) {
    std::atomic_ref<std::uint8_t>(lit_[grain]).store(1, std::memory_order_relaxed);
  }

  /// Two grains touch, or did in the step before. By any thread. Local.
  void note_touch(std::size_t a, std::size_t b) {
    if (asleep_[a] != asleep_[b]) mark(asleep_[a] != 0 ? a : b);
    if (is_look_ && slow_[a] == 0) mark(b);
    if (is_look_ && slow_[b] == 0) mark(a);
  }
  /// The same for a grain and a body that moves.
  void note_moving_touch(std::size_t grain) { mark(grain); }

  /// What a thread finds out about who sleeps.
  struct Change {
    bool is_any = false;
    ExactSum taken;  ///< kinetic energy of those that fell asleep [J]
    void add(const Change& other) {
      is_any |= other.is_any;
      taken.add(other.taken);
    }
  };
  /// Whether an owned grain stays where it is in this step: it goes on sleeping or falls asleep.
  /// Sets its velocity when it falls asleep or wakes. After this no other grain may ask for it.
  /// @param force,moment of all contacts, of a grain that is_wanted [N], [N m]. By any thread.
  bool rests(std::size_t grain, Particle& p, const Vec3& force, const Vec3& moment, Change& change);

  /// Ends the step. Local.
  /// @param is_any whether a grain fell asleep or woke on this rank
  /// @param taken  kinetic energy of those that fell asleep on all ranks [J]
  void end_step(bool is_any, double taken);
  /// Kinetic energy of all that have fallen asleep since the start of the run [J].
  double taken() const { return taken_; }

  /// Only when it is on: a state without sleep is that of a program without it.
  void save_state(const Communicator& ranks, State& state, const StatePiece& piece) const;
  void load_rows(const Communicator& ranks, const StateTable& rows);

 private:
  void mark(std::size_t grain) {
    std::atomic_ref<std::uint8_t>(marked_[grain]).store(1, std::memory_order_relaxed);
  }
  bool is_out_of_balance(const Particle& p, Vec3 force, const Vec3& moment, double share) const;

  ActivityRule rule_;
  double gravity_;
  std::int64_t steps_ = 0;  // since the start of the run
  double taken_ = 0.0;
  bool is_look_ = false;
  bool may_wake_ = false;
  bool has_changed_ = true;
  bool may_have_changed_ = true;  // owned grains, in the step before
  // Of owned grains and ghosts, before the step.
  std::vector<std::uint8_t> asleep_;
  std::vector<std::uint8_t> slow_;  // only when it is a look
  std::vector<std::uint8_t> lit_;
  std::vector<std::uint8_t> marked_;  // touched by what is awake or, at a look, not slow
};

}  // namespace grouser
