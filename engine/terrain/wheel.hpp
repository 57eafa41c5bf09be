// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "base/case.hpp"
#include "engine/dem/world.hpp"
#include "engine/terrain/bed.hpp"

namespace grouser {

/// What the soil does to the wheel, averaged over the steps since the last sample, and how the
/// wheel moves. Signs as in docs/reference/formats/run_directory.md.
struct WheelSample {
  double travel = 0.0;                 ///< forward distance since the start [m]
  double sinkage = 0.0;                ///< of the lowest point below the undisturbed surface [m]
  double forward_speed = 0.0;          ///< [m s-1]
  double vertical_speed = 0.0;         ///< [m s-1]
  double spin = 0.0;                   ///< about the axle, forward positive [rad s-1]
  double pull = 0.0;                   ///< forward force of the soil, drawbar pull [N]
  double vertical_force = 0.0;         ///< upward [N]
  double side_force = 0.0;             ///< along y [N]
  double gross_tractive_effort = 0.0;  ///< of the contact forces, without couples [N]
  double axle_torque = 0.0;            ///< given to the axle, forward positive [N m]
  double max_overlap = 0.0;            ///< largest of the steps, over the radius [1]

  double motion_resistance() const { return gross_tractive_effort - pull; }
  /// Slip i = 1 - v/(omega r); NaN where the wheel does not turn forward.
  double slip(double radius) const;
  /// Skid j = (v - omega r)/v; NaN where the wheel does not move forward.
  double skid(double radius) const;
};

/// A wheel on its way through the bed: vertical settling, then driving under the case's
/// prescription. Free vertical motion has the mass load/gravity. While it settles a damper of
/// load/settle_speed may slow its fall onto the bed; it is off while driving.
class Wheel : public Stateful {
 public:
  /// @param body number of the wheel's body in the world
  Wheel(const Case& input, World& world, std::size_t body);

  /// Puts the wheel at its start so that its outer circle just touches the highest grain below it,
  /// and measures the undisturbed surface along its track. Collective.
  void place();

  /// Moves the wheel by one step under the load of the step just done, and adds the step to the
  /// running sample. @param time at the end of the step [s]. Local.
  void advance(double time, double max_overlap);

  bool is_driving(double time) const { return time > input_.settle_time; }
  double radius() const { return 0.5 * input_.diameter; }

  /// What makes going on meaningless, or "": wheel and box do not touch each other, so a wheel that
  /// meets the floor or an end wall would go through it. Local.
  std::string fault() const;

  /// The sample since the last call; begins the next. Local.
  WheelSample take_sample();

  void save_state(State& state, const StatePiece& piece = {}) const override;
  void begin_load() override { is_loaded_ = false; }
  void load_rows(const StateTable& rows) override;
  void end_load() override;

 private:
  double speed_factor(double time) const;
  /// Moves forward and spin on. @return torque on the axle in this step [N m]
  double drive(BodyMotion& motion, double time, double moment) const;

  WheelCase input_;
  World& world_;
  std::size_t body_;
  double gravity_;
  double inertia_;
  double start_x_ = 0.0;
  double surface_ = 0.0;
  bool is_loaded_ = false;
  // Sums over the steps since the last sample.
  double steps_ = 0.0;
  double pull_ = 0.0;
  double vertical_ = 0.0;
  double side_ = 0.0;
  double gross_ = 0.0;
  double torque_ = 0.0;
  double forward_ = 0.0;
  double spin_ = 0.0;
  double overlap_ = 0.0;
};

}  // namespace grouser
