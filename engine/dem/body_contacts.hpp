// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/exact_sum.hpp"
#include "engine/core/particle.hpp"
#include "engine/core/state_io.hpp"
#include "engine/dem/body.hpp"
#include "engine/dem/laws/table.hpp"

namespace grouser {

/// Force [N] and moment about the body's axle [N m] of the grains on a body; sums that do not
/// depend on ranks.
struct BodyLoad {
  ExactSum force_x, force_y, force_z;
  ExactSum force_moment_y;  ///< of the contact forces: force tangential to the circle x distance
  ExactSum couple_y;        ///< rolling resistance of the grains, which has no force

  double moment_y() const { return force_moment_y.value() + couple_y.value(); }
};

/// Contacts of owned grains with one body, under the same laws as grain pairs. A grain may touch a
/// body in several places (a corner); each touch has its own history, which follows the grain from
/// facet to neighbouring facet.
class BodyContacts {
 public:
  BodyContacts(ContactLaw law, RollingLaw rolling);

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

  /// What a touch does to its grain: force [N] and moment about its centre [N m].
  struct Push {
    std::uint32_t particle = 0;
    Vec3 force;
    Vec3 moment;
  };

  /// Evaluates all touches; adds the opposite to `load`.
  /// @return largest overlap over grain radius [1]
  double sweep(const std::vector<Particle>& particles, const Body& body, double time_step,
               BodyLoad& load);
  /// Of the last sweep, ordered by grain.
  const std::vector<Push>& pushes() const { return pushes_; }

  std::size_t count() const { return touches_.size(); }
  std::size_t history_width() const { return history_width_; }

  /// The touch of an owned grain; `at` counts up through touches ordered by grain.
  struct Touch {
    std::uint32_t particle = 0;
    int facet = 0;
  };
  const std::vector<Touch>& touches() const { return touches_; }
  const double* history(std::size_t touch) const {
    return history_.data() + touch * history_width_;
  }

 private:
  template <class Law, class Rolling>
  double sweep(const Law& law, const Rolling& rolling, const std::vector<Particle>& particles,
               const Body& body, double time_step, BodyLoad& load);
  /// Finds the history of a touch among those of the same grain in the step before.
  void inherit(std::size_t first, std::size_t last, const MeshSearch& search,
               const std::vector<MeshTouch>& now, std::vector<double>& histories);

  ContactLaw law_;
  RollingLaw rolling_;
  std::size_t history_width_ = 0;
  void find_close(const std::vector<Particle>& particles, const Body& body);

  double skin_ = 0.0;
  std::vector<std::uint32_t> near_;
  // Of them, those that may touch before grains or body have come closer by gap_, each with the
  // number of facets it may touch, and those facets one grain after the other.
  struct Close {
    std::uint32_t particle;
    std::uint32_t facets;
  };
  std::vector<Close> close_;
  std::vector<int> facets_;
  double gap_ = 0.0;            // [m]; 0 = not known
  double travel_ = 0.0;         // bound of how much closer they have come since [m]
  std::vector<Touch> touches_;  // of the last step, by grain, then facet
  std::vector<double> history_;
  std::vector<Push> pushes_;
  std::vector<Touch> next_touches_;
  std::vector<double> next_history_;
};

}  // namespace grouser
