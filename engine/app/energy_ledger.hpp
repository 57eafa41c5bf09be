// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "engine/dem/world.hpp"

namespace grouser {

/// Notices grains that gain energy which nothing gave them, as contacts do when the time step is
/// too long for them: long before grains fly, overlap too far or are not numbers any more.
///
/// Energy of the grains (motion, height, elastic) less the work that bodies have done on them can
/// only fall. What it has risen above its lowest value so far has come from nothing; when that is
/// more than half of the kinetic energy and of kShare of the elastic energy, grains heat up.
/// Neglected: what damping takes in the same time hides as much of the gain. The work of a step is
/// force times the body's velocity, to first order in the time step.
class EnergyLedger : public Stateful {
 public:
  /// Steps of the run between two looks; a look costs less than a step.
  static constexpr std::int64_t kInterval = 100;
  /// Share of the elastic energy below which rounding and the scheme's first order may be at work.
  static constexpr double kShare = 0.05;

  explicit EnergyLedger(const Communicator& ranks) : ranks_(ranks) {}

  /// Adds what the bodies did to the grains in the step just done; before they move on. Local.
  void add_work(const World& world);

  /// Takes the energy at this step. @return whether the grains heat up. Local.
  bool rises(const World::Survey& survey);
  double rise() const { return rise_; }  ///< at the last look, from nothing [J]
  double work() const { return work_; }  ///< of bodies on grains since the start of the run [J]

  void save_state(State& state, const StatePiece& piece = {}) const override;
  void begin_load() override {}
  void load_rows(const StateTable& rows) override;
  void end_load() override {}

 private:
  Communicator ranks_;
  double work_ = 0.0;
  // Of energy less work.
  double lowest_ = std::numeric_limits<double>::max();
  double rise_ = 0.0;
};

}  // namespace grouser
