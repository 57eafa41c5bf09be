// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "base/fluid_case.hpp"
#include "engine/coupling/history_modes.hpp"
#include "engine/coupling/laws/table.hpp"
#include "engine/dem/grain_forces.hpp"

namespace grouser {

/// Forces on one grain in one step, by what makes them.
struct ForceParts {
  enum Part {
    kContact,
    kWeight,
    kBuoyancy,
    kDrag,
    kAddedMass,
    kHistory,
    kShearLift,
    kSpinLift,
    kLubrication,
    kProbe,
    kParts
  };
  std::array<Vec3, kParts> force;  ///< [N]
};
/// Names of the parts as in track.csv, in order.
inline constexpr std::array<const char*, ForceParts::kParts> kPartNames{
    "contact", "weight",     "buoyancy",  "drag",        "added_mass",
    "history", "shear_lift", "spin_lift", "lubrication", "probe"};

/// Where a box's walls are: the floor z = 0, x = 0 and length, y = 0 and width [m].
struct BoxWalls {
  double length = 0.0;
  double width = 0.0;
};

/// The one-way ("submerged") forces of a fluid on a grain: the fluid moves as prescribed, whatever
/// grains do in it.
///
/// Drag and lubrication are integrated as an exponential over the step, so that no drag is too
/// stiff to be stable; added mass and the newest half step of the history are part of the inertia,
/// so that light grains are stable as well. Second order in the time step, where velocity and spin
/// of the middle of the step are used throughout; spin drag is first order if its law depends on
/// the spin. Neglected: what grains do to the fluid and so to each other, the fluid's surface,
/// lubrication between grains and towards the wheel.
class FluidForces {
 public:
  FluidForces(const FluidCase& input, const BoxWalls& walls, double time_step, double gravity);

  bool has_history() const { return input_.history.amplitude > 0.0; }

  /// The gain of a grain, and in `parts` what made it. `memory` is renewed; it may be null without
  /// history. @param extra a further force on the grain [N]. Local.
  GrainGain gain(const Particle& p, const GrainLoad& load, const Vec3& extra,
                 HistoryModes::Memory* memory, ForceParts& parts) const;

  /// Reynolds number of a grain that moves like this [1]. Local.
  double reynolds(const Particle& p, const Vec3& velocity) const;

 private:
  // What depends on the velocity in the middle of the step.
  struct Terms {
    double drag = 0.0;  // [N s m-1]
    Vec3 shear_lift;    // [N]
    Vec3 spin_lift;     // [N]
    Vec3 past;          // history but for the newest half step [N]
  };

  FluidPoint point(const Particle& p, const Vec3& velocity, const Vec3& spin) const;
  Vec3 fluid_velocity(const Vec3& at) const;
  double drag(const FluidPoint& at) const;
  Vec3 films(const Particle& p) const;
  Terms terms(const FluidPoint& at, const HistoryModes::Memory* memory) const;
  Vec3 turn(const Particle& p, const Vec3& moment) const;

  FluidCase input_;
  BoxWalls walls_;
  double time_step_;
  double gravity_;
  Fluid fluid_;
  HistoryModes modes_;
  DragLaw drag_;
  AddedMassLaw added_mass_;
  HistoryLaw history_;
  ShearLiftLaw shear_lift_;
  SpinLiftLaw spin_lift_;
  SpinDragLaw spin_drag_;
  LubricationLaw lubrication_;
  WallLaw wall_;
};

}  // namespace grouser
