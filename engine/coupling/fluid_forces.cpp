// SPDX-License-Identifier: BSD-3-Clause
#include "engine/coupling/fluid_forces.hpp"

#include <cmath>
#include <numbers>

namespace grouser {
namespace {

constexpr double kPi = std::numbers::pi;

// (1 - e^-x)/x: what is left of a force over a step in which drag lets speed decay by e^-x.
double mean_decay(double x) { return x == 0.0 ? 1.0 : -std::expm1(-x) / x; }

// Force over the integral of a kernel t^(-1/2): 3 pi mu d d / sqrt(4 pi nu) [N s^(3/2) m-1].
double history_scale(const Fluid& fluid, double diameter) {
  return 1.5 * diameter * diameter * std::sqrt(kPi * fluid.density * fluid.viscosity);
}

Vec3 times(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

}  // namespace

FluidForces::FluidForces(const FluidCase& input, const BoxWalls& walls, double time_step,
                         double gravity)
    : input_(input),
      walls_(walls),
      time_step_(time_step),
      gravity_(gravity),
      fluid_{input.density, input.viscosity},
      modes_(time_step),
      drag_(law_named<DragLaw>(input.drag.law)),
      added_mass_(law_named<AddedMassLaw>(input.added_mass.law)),
      history_(law_named<HistoryLaw>(input.history.law)),
      shear_lift_(law_named<ShearLiftLaw>(input.shear_lift.law)),
      spin_lift_(law_named<SpinLiftLaw>(input.spin_lift.law)),
      spin_drag_(law_named<SpinDragLaw>(input.spin_drag.law)),
      lubrication_(law_named<LubricationLaw>(input.lubrication.law)),
      wall_(law_named<WallLaw>(input.wall.law)) {}

Vec3 FluidForces::fluid_velocity(const Vec3& at) const {
  return {input_.velocity_x + input_.shear_rate * at.z, input_.velocity_y, input_.velocity_z};
}

FluidPoint FluidForces::point(const Particle& p, const Vec3& velocity, const Vec3& spin) const {
  FluidPoint at;
  at.fluid = fluid_;
  at.diameter = 2.0 * p.radius;
  at.slip = fluid_velocity(p.position) - velocity;
  at.vorticity = {0.0, input_.shear_rate, 0.0};
  at.spin = spin;
  at.void_fraction = input_.void_fraction;
  return at;
}

double FluidForces::reynolds(const Particle& p, const Vec3& velocity) const {
  return point(p, velocity, {}).reynolds();
}

double FluidForces::drag(const FluidPoint& at) const {
  const double amplitude = input_.drag.amplitude;
  if (amplitude == 0.0) return 0.0;
  const double reynolds = at.reynolds();
  double slowed = 1.0;
  if (input_.wall.amplitude > 0.0) {
    const double ratio = at.diameter / input_.wall_diameter;
    slowed = std::visit(
        [&](const auto& law) {
          // The law's Reynolds number is of the unbounded sphere; it converges in two rounds.
          double factor = law.factor(ratio, reynolds);
          for (int i = 0; i < 2; ++i) factor = law.factor(ratio, reynolds / factor);
          return factor;
        },
        wall_);
    slowed = 1.0 - input_.wall.amplitude * (1.0 - slowed);
  }
  const double factor = std::visit(
      [&](const auto& law) { return law.factor(reynolds / slowed, at.void_fraction); }, drag_);
  return amplitude * 3.0 * kPi * fluid_.viscosity * at.diameter * factor / slowed;
}

// Resistance of the films towards the box's walls, per direction [N s m-1].
Vec3 FluidForces::films(const Particle& p) const {
  if (input_.lubrication.amplitude == 0.0) return {};
  const auto film = [&](double distance) {
    return std::visit(
        [&]<class Law>(const Law&) {
          return input_.lubrication.amplitude *
                 lubrication_coefficient<Law>(fluid_, p.radius, distance - p.radius,
                                              input_.smallest_gap, input_.cutoff_gap);
        },
        lubrication_);
  };
  return {film(p.position.x) + film(walls_.length - p.position.x),
          film(p.position.y) + film(walls_.width - p.position.y), film(p.position.z)};
}

FluidForces::Terms FluidForces::terms(const FluidPoint& at,
                                      const HistoryModes::Memory* memory) const {
  Terms terms;
  terms.drag = drag(at);
  if (input_.shear_lift.amplitude > 0.0)
    terms.shear_lift = input_.shear_lift.amplitude *
                       std::visit([&](const auto& law) { return law.force(at); }, shear_lift_);
  if (input_.spin_lift.amplitude > 0.0)
    terms.spin_lift = input_.spin_lift.amplitude *
                      std::visit([&](const auto& law) { return law.force(at); }, spin_lift_);
  if (memory != nullptr && has_history()) {
    const double time = std::visit([&](const auto& law) { return law.memory(at); }, history_);
    terms.past = (-input_.history.amplitude * history_scale(fluid_, at.diameter)) *
                 modes_.past(modes_.weights(time), *memory);
  }
  return terms;
}

Vec3 FluidForces::turn(const Particle& p, const Vec3& moment) const {
  const double inertia = kSphereInertia * p.mass * p.radius * p.radius;
  if (input_.spin_drag.amplitude == 0.0) return (time_step_ / inertia) * moment;
  const FluidPoint at = point(p, p.velocity, p.spin);
  const double resistance =
      input_.spin_drag.amplitude *
      std::visit([&](const auto& law) { return law.coefficient(at); }, spin_drag_);
  return (time_step_ / inertia * mean_decay(resistance * time_step_ / inertia)) *
         (moment - resistance * at.relative_spin());
}

GrainGain FluidForces::gain(const Particle& p, const GrainLoad& load, const Vec3& extra,
                            HistoryModes::Memory* memory, ForceParts& parts) const {
  const double dt = time_step_;
  const double displaced = fluid_.density * (4.0 / 3.0) * kPi * p.radius * p.radius * p.radius;
  const double added =
      input_.added_mass.amplitude * displaced *
      std::visit([&](const auto& law) { return law.share(input_.void_fraction); }, added_mass_);
  const double local =
      has_history()
          ? input_.history.amplitude * history_scale(fluid_, 2.0 * p.radius) * modes_.local_weight()
          : 0.0;
  const double mass = p.mass + added + local;
  const Vec3 film = films(p);
  const Vec3 fluid = fluid_velocity(p.position);
  const Vec3 weight{0.0, 0.0, -p.mass * gravity_};
  const Vec3 lift{0.0, 0.0, input_.buoyancy.amplitude * displaced * gravity_};

  GrainGain gain;
  gain.spin = turn(p, load.moment);
  const Vec3 spin = p.spin + 0.5 * gain.spin;
  Terms now;
  Vec3 change;      // of the fluid's velocity along the grain's path [m s-2]
  Vec3 resistance;  // [N s m-1]
  for (int round = 0; round < 2; ++round) {
    const Vec3 middle = p.velocity + 0.5 * gain.velocity;
    now = terms(point(p, middle, spin), memory);
    change = {input_.shear_rate * middle.z, 0.0, 0.0};
    resistance = Vec3{now.drag, now.drag, now.drag} + film;
    Vec3 force = load.force + extra;
    if (input_.buoyancy.amplitude > 0.0) force += lift;
    force += now.shear_lift + now.spin_lift + now.past + local * change;
    if (resistance == Vec3{} && mass == p.mass) {
      gain.velocity = plain_gain(p, {force, load.moment}, dt, gravity_).velocity;
      continue;
    }
    force += weight + now.drag * fluid - times(resistance, p.velocity);
    const Vec3 decay{mean_decay(resistance.x * dt / mass), mean_decay(resistance.y * dt / mass),
                     mean_decay(resistance.z * dt / mass)};
    gain.velocity = (dt / mass) * times(decay, force);
  }

  const Vec3 acceleration = (1.0 / dt) * gain.velocity;
  const Vec3 slip_acceleration = acceleration - change;
  if (memory != nullptr && has_history()) modes_.remember(slip_acceleration, *memory);
  using Part = ForceParts::Part;
  auto& f = parts.force;
  f[Part::kContact] = load.force;
  f[Part::kWeight] = weight;
  f[Part::kBuoyancy] = input_.buoyancy.amplitude > 0.0 ? lift : Vec3{};
  f[Part::kAddedMass] = -added * acceleration;
  f[Part::kHistory] = now.past - local * slip_acceleration;
  f[Part::kShearLift] = now.shear_lift;
  f[Part::kSpinLift] = now.spin_lift;
  f[Part::kProbe] = extra;
  // What the others leave of the acceleration is drag and film, which share a mean velocity.
  Vec3 rest = p.mass * acceleration;
  for (const Part part : {Part::kContact, Part::kWeight, Part::kBuoyancy, Part::kAddedMass,
                          Part::kHistory, Part::kShearLift, Part::kSpinLift, Part::kProbe})
    rest -= f[part];
  const Vec3 driven = now.drag * fluid - rest;
  const auto held = [](double part, double all, double by) {
    return all > 0.0 ? -part * by / all : 0.0;
  };
  f[Part::kLubrication] = {held(film.x, resistance.x, driven.x),
                           held(film.y, resistance.y, driven.y),
                           held(film.z, resistance.z, driven.z)};
  f[Part::kDrag] = rest - f[Part::kLubrication];
  return gain;
}

}  // namespace grouser
