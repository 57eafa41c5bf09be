// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "tests/engine/fluid_world.hpp"

namespace grouser {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kG = 9.81;

// A nylon sphere in the oil of ten Cate's case E4.
constexpr double kRadius = 7.5e-3;
constexpr double kOil = 960.0;
constexpr double kViscosity = 0.058;
const double kVolume = 4.0 / 3.0 * kPi * kRadius * kRadius * kRadius;

Particle nylon(double height = 50.0) { return sphere(0, kRadius, {0.5, 0.5, height}, 1120.0); }
Case oil() { return fluid_case(kOil, kViscosity, 1.0); }

double schiller_naumann(double re) { return 1.0 + 0.15 * std::pow(re, 0.687); }

// Downward speed of the sphere let go from rest, with drag, buoyancy and added mass, at time `end`.
double settling_speed(double end) {
  const double mass = 1120.0 * kVolume + 0.5 * kOil * kVolume;
  const double weight = (1120.0 - kOil) * kVolume * kG;
  return runge_kutta(
      [&](double, double v) {
        const double re = kOil * 2.0 * kRadius * std::abs(v) / kViscosity;
        return (weight - 6.0 * kPi * kViscosity * kRadius * schiller_naumann(re) * v) / mass;
      },
      0.0, end, 2000);
}

// The engine's, with this time step.
double engine_speed(double end, double dt) {
  Case input = oil();
  input.fluid.added_mass.amplitude = 1.0;
  OneGrain one(input, nylon(), dt, kG);
  // Velocities begin half a step behind: a quarter of what the first step would change is put in.
  TrackRow row;
  while (one.time() < end + 0.5 * dt) row = one.step();
  return -row.velocity.z;
}

TEST(Settling, FollowsTheEquationOfMotion) {
  for (const double end : {0.05, 0.2, 0.8})
    EXPECT_NEAR(engine_speed(end, 1e-4) / settling_speed(end), 1.0, 2e-3) << end;
}

TEST(Settling, EndsAtTheTerminalSpeedOfItsDragLaw) {
  for (const char* law : {"stokes", "schiller_naumann", "dallavalle", "brown_lawler", "abraham"}) {
    Case input = oil();
    input.fluid.drag.law = law;
    OneGrain one(input, nylon(), 2e-3, kG);
    TrackRow row;
    for (int i = 0; i < 4000; ++i) row = one.step();
    const double factor = std::visit([&](const auto& l) { return l.factor(row.reynolds, 1.0); },
                                     law_named<DragLaw>(law));
    const double balance = 6.0 * kPi * kViscosity * kRadius * factor * -row.velocity.z;
    EXPECT_NEAR(balance / ((1120.0 - kOil) * kVolume * kG), 1.0, 1e-9) << law;
  }
}

TEST(Settling, IsSecondOrderInTheTimeStep) {
  // Started with the velocity half a step back that the exact solution continues to.
  const auto error = [](double dt) {
    Case input = oil();
    input.fluid.added_mass.amplitude = 1.0;
    Particle grain = nylon();
    const double begin = 0.1;
    grain.velocity.z = -settling_speed(begin - 0.5 * dt);
    OneGrain one(input, grain, dt, kG);
    const int steps = static_cast<int>(std::lround(0.1 / dt));
    for (int i = 0; i < steps; ++i) one.step();
    return std::abs(-one.grain().velocity.z - settling_speed(begin + (steps - 0.5) * dt));
  };
  const double coarse = error(4e-3);
  const double fine = error(2e-3);
  EXPECT_GT(coarse, 1e-8);  // else rounding is all there is
  EXPECT_GT(coarse / fine, 3.4);
  EXPECT_LT(coarse / fine, 4.6);
}

TEST(Settling, DragTooStiffForTheStepIsStable) {
  Case input = fluid_case(1000.0, 10.0, 1.0);
  input.fluid.drag.law = "stokes";
  OneGrain one(input, sphere(0, 1e-4, {0.5, 0.5, 50.0}), 1e-3, kG);  // 175 drag times to a step
  TrackRow row;
  for (int i = 0; i < 20; ++i) row = one.step();
  EXPECT_NEAR(row.velocity.z / (-2.0 / 9.0 * 1650.0 * kG * 1e-8 / 10.0), 1.0, 1e-9);
}

TEST(AddedMass, HoldsALightGrainBack) {
  // A bubble: without added mass 99 g upwards, with it (1 - 0.01)/(0.01 + 0.5) g.
  Case input = fluid_case(1000.0, 1e-9, 1.0);
  input.fluid.added_mass.amplitude = 1.0;
  OneGrain one(input, sphere(0, 1e-3, {0.5, 0.5, 0.5}, 10.0), 1e-5, kG);
  const TrackRow row = one.step();
  EXPECT_NEAR(row.acceleration.z / (0.99 / 0.51 * kG), 1.0, 1e-6);
  EXPECT_LT(row.parts.force[ForceParts::kAddedMass].z, 0.0);
}

// Speed of a sphere let go from rest in creeping flow with added mass and Basset's history under a
// constant force, exact (Boussinesq 1885): v = F/c - F b/pi int e^(-rt) r^(-1/2)/((c - M r)^2 + b^2
// r) dr over r > 0, from the cut of its Laplace transform F/(s (M s + b sqrt(s) + c)).
double boussinesq(double force, double mass, double drag, double b, double time) {
  double sum = 0.0;
  const double h = 0.01;
  for (double x = -60.0; x < 30.0; x += h) {
    const double r = std::exp(x) * drag / mass;
    const double left = drag - mass * r;
    sum += h * std::exp(-r * time) * std::sqrt(r) / (left * left + b * b * r);
  }
  return force / drag - force * b / kPi * sum;
}

TEST(History, GivesBoussinesqsExactSettlingFromRest) {
  for (const double density : {100.0, 1120.0, 8000.0}) {
    Case input = fluid_case(970.0, 0.373, 1.0);
    input.fluid.drag.law = "stokes";
    input.fluid.added_mass.amplitude = 1.0;
    input.fluid.history.amplitude = 1.0;
    const double mass = (density + 0.5 * 970.0) * kVolume;
    const double drag = 6.0 * kPi * 0.373 * kRadius;
    // 6 a^2 sqrt(pi rho mu) sqrt(pi)
    const double b = 6.0 * kRadius * kRadius * kPi * std::sqrt(970.0 * 0.373);
    const double force = (density - 970.0) * kVolume * kG;
    const double dt = 1e-4;
    OneGrain one(input, sphere(0, kRadius, {0.5, 0.5, 50.0}, density), dt, kG);
    for (const double end : {0.01, 0.1, 1.0}) {
      TrackRow row;
      while (one.time() < end - 0.5 * dt) row = one.step();
      // Half a step's lag at the start, and 5e-4 of the kernel.
      const double exact = boussinesq(force, mass, drag, b, end - 0.5 * dt);
      EXPECT_NEAR(-row.velocity.z / exact, 1.0, 0.5 * dt / end + 2e-3) << density << " " << end;
    }
  }
}

TEST(History, OfMeiAndAdrianLetsAGrainReachItsTerminalSpeedSooner) {
  const auto missing = [](const char* law) {
    Case input = oil();
    input.fluid.added_mass.amplitude = 1.0;
    input.fluid.history = {law, 1.0};
    OneGrain one(input, nylon(), 5e-4, kG);
    TrackRow row;
    while (one.time() < 2.0) row = one.step();
    return 1.0 + row.velocity.z / settling_speed(20.0);
  };
  // Basset's tail falls as t^(-1/2) for ever, Mei and Adrian's as t^-2.
  EXPECT_GT(missing("basset"), 0.01);
  EXPECT_LT(missing("mei_adrian"), 0.2 * missing("basset"));
  EXPECT_GT(missing("mei_adrian"), 0.0);
}

TEST(Lubrication, SlowsTheApproachToTheFloorAsTheFilmsLawSays) {
  Case input = fluid_case(970.0, 0.373, 1.0);
  input.fluid.drag.law = "stokes";
  input.fluid.lubrication = {"brenner", 1.0};
  input.fluid.cutoff_gap = 10.0;
  OneGrain one(input, nylon(kRadius + 0.5 * kRadius), 1e-4, kG);
  for (int i = 0; i < 10000; ++i) one.step();
  // Inertia dies out within 0.02 s; after that the gap follows weight over resistance.
  const double force = (1120.0 - 970.0) * kVolume * kG;
  const double beyond = BrennerLubrication::excess(10.0);
  const double gap = runge_kutta(
      [&](double, double h) {
        return -force / (6.0 * kPi * 0.373 * kRadius *
                         (1.0 + BrennerLubrication::excess(h / kRadius) - beyond));
      },
      0.5 * kRadius, 1.0, 4000);
  EXPECT_NEAR((one.grain().position.z - kRadius) / gap, 1.0, 0.05);
  EXPECT_LT(gap, 0.1 * kRadius);
}

TEST(Drag, NeverGivesAGrainEnergy) {
  for (const char* law : {"stokes", "schiller_naumann", "koch_hill", "beetstra", "gidaspow"})
    for (const double dt : {1e-5, 1e-3, 1e-1}) {
      Case input = oil();
      input.fluid.drag.law = law;
      input.fluid.void_fraction = 0.6;
      input.fluid.spin_drag = {"dennis", 1.0};
      input.fluid.spin_lift.amplitude = 1.0;
      Particle grain = nylon();
      grain.velocity = {0.3, -0.2, 0.1};
      grain.spin = {20.0, 5.0, -40.0};
      // Without gravity there is but drag, torque and lift, which does no work: it is normal to the
      // velocity, as long as a step does not turn it by much.
      if (dt > 0.01) input.fluid.spin_lift.amplitude = 0.0;
      OneGrain one(input, grain, dt, 1e-300);
      for (int i = 0; i < 50; ++i) {
        const double before = norm2(one.grain().velocity);
        const double spin = norm2(one.grain().spin);
        one.step();
        EXPECT_LE(norm2(one.grain().velocity), before * (1.0 + 1e-12)) << law << " " << dt;
        EXPECT_LE(norm2(one.grain().spin), spin) << law << " " << dt;
      }
    }
}

TEST(Drag, CarriesAGrainAlongWithSpeedAndSpinOfTheFluid) {
  Case input = oil();
  input.fluid.velocity_x = 0.2;
  input.fluid.velocity_y = -0.1;
  input.fluid.shear_rate = 2.0;
  input.fluid.spin_drag.amplitude = 1.0;
  OneGrain one(input, sphere(0, kRadius, {0.5, 0.5, 0.1}, kOil), 1e-3,
               kG);  // neither sinks nor rises
  TrackRow row;
  for (int i = 0; i < 4000; ++i) row = one.step();
  EXPECT_NEAR(row.velocity.x, 0.2 + 2.0 * 0.1, 1e-5);
  EXPECT_NEAR(row.velocity.y, -0.1, 1e-5);
  EXPECT_NEAR(row.spin.y, 1.0, 1e-3);  // half of the vorticity, forward
}

TEST(Wall, SlowsTheSettlingByItsFactor) {
  const auto terminal = [](const char* law) {
    Case input = fluid_case(970.0, 10.0, 1.0);
    input.fluid.drag.law = "stokes";
    input.fluid.wall.law = law;
    input.fluid.wall_diameter = 0.1;
    OneGrain one(input, nylon(), 1e-4, kG);
    TrackRow row;
    for (int i = 0; i < 200; ++i) row = one.step();
    return row.velocity.z;
  };
  EXPECT_NEAR(terminal("haberman_sayre") / terminal("none"), HabermanSayreWall::factor(0.15, 0.0),
              1e-6);
  EXPECT_LT(terminal("di_felice") / terminal("none"), 0.75);
}

TEST(Parts, AddUpToMassTimesAcceleration) {
  Case input = oil();
  FluidCase& f = input.fluid;
  f.velocity_x = 0.1;
  f.velocity_z = 0.05;
  f.shear_rate = 3.0;
  f.added_mass.amplitude = 1.0;
  f.history = {"mei_adrian", 0.7};
  f.shear_lift.amplitude = f.spin_lift.amplitude = f.spin_drag.amplitude = 1.0;
  f.lubrication.amplitude = 1.0;
  input.probes.push_back({0, "y", "time", 0.0, 0.01, 0.1, 1e-3});
  Particle grain = nylon(1.4 * kRadius);
  grain.velocity = {-0.1, 0.2, -0.3};
  grain.spin = {1.0, 10.0, 5.0};
  OneGrain one(input, grain, 1e-4, kG);
  for (int i = 0; i < 20; ++i) {
    const TrackRow row = one.step();
    Vec3 sum;
    for (const Vec3& force : row.parts.force) sum += force;
    EXPECT_LT(norm(sum - grain.mass * row.acceleration), 1e-12);
    // Films and drag hold back.
    EXPECT_GT(row.parts.force[ForceParts::kLubrication].z, 0.0);
    EXPECT_LT(row.parts.force[ForceParts::kDrag].y, 0.0);
    EXPECT_GT(norm(row.parts.force[ForceParts::kHistory]), 0.0);
  }
}

TEST(Probe, OverTimeGivesTheImpulseOfItsHat) {
  Case input;
  input.box.length = input.box.width = 1.0;
  input.probes.push_back({0, "x", "time", 0.01, 0.02, 0.05, 3e-3});
  OneGrain one(input, nylon(), 1e-4, kG);
  for (int i = 0; i < 700; ++i) one.step();
  EXPECT_NEAR(one.grain().velocity.x * one.grain().mass, 0.5 * 3e-3 * 0.04, 1e-9);
  EXPECT_EQ(one.grain().velocity.y, 0.0);
}

TEST(Probe, OverTheGapActsWhereItsHatIs) {
  Case input = oil();
  input.probes.push_back({0, "z", "gap", 0.01, 0.02, 0.03, 1e-3});
  OneGrain one(input, nylon(kRadius + 0.04), 1e-3, kG);
  bool acted = false;
  for (int i = 0; i < 500; ++i) {
    const TrackRow row = one.step();
    const double force = row.parts.force[ForceParts::kProbe].z;
    const bool inside = row.gap > 0.01 && row.gap < 0.03;
    EXPECT_EQ(force > 0.0, inside) << row.gap;
    const double hat = std::max(0.0, 1e-3 * (1.0 - std::abs(row.gap - 0.02) / 0.01));
    EXPECT_NEAR(force, hat, 1e-12);
    acted = acted || inside;
  }
  EXPECT_TRUE(acted);
}

TEST(Probe, OverSpeedAndReynoldsNumberFollowsThem) {
  for (const char* along : {"speed", "reynolds"}) {
    Case input = oil();
    const double top =
        std::string(along) == "speed" ? 0.05 : kOil * 2.0 * kRadius * 0.05 / kViscosity;
    input.probes.push_back({0, "z", along, 0.0, top, 2.0 * top, 1e-3});
    Particle grain = nylon();
    grain.velocity.z = -0.05;
    OneGrain one(input, grain, 1e-6, kG);
    EXPECT_NEAR(one.step().parts.force[ForceParts::kProbe].z, 1e-3, 1e-9) << along;
  }
}

// Speed after over speed before a bounce on the floor, of a steel sphere let go at the speed it has
// when its gap is a radius.
double bounce(double viscosity, double amplitude) {
  Case input = fluid_case(935.0, viscosity, 0.1);
  input.fluid.added_mass.amplitude = 1.0;
  input.fluid.lubrication = {"leading", amplitude};
  Particle grain = sphere(0, 1.5e-3, {0.05, 0.05, 3e-3}, 7800.0);
  grain.velocity.z = -0.5;
  WorldSettings settings = small_settings();
  settings.gravity = 0.0;
  settings.time_step = 1e-6;
  settings.largest_radius = 1.5e-3;
  settings.skin = 1e-3;
  settings.grain = {1e11, 0.25};
  World world(Communicator::alone(), settings);
  world.add_body("box", box_mesh(0.1, 0.1, 0.4), {1e11, 0.25}, {0.97, 0.1, 0.0}, false);
  OuterForces outer(input, world);
  world.add_particle(grain);
  double before = 0.0;
  for (int i = 0; i < 20000; ++i) {
    outer.announce(i, i * 1e-6, false);
    world.step();
    const Particle& p = world.particles()[0];
    before = std::max(before, -p.velocity.z);
    if (p.velocity.z > 0.0 && p.position.z > 3e-3) return p.velocity.z / before;
  }
  return 0.0;
}

TEST(Bounce, ComesBackMoreTheHigherTheStokesNumber) {
  // St = rho_s d v / (9 mu): 260, 43 and 2.6. Measured (Gondret et al. 2002): about 0.9 of the dry
  // restitution at 260, half at 40, none below 10.
  const double high = bounce(0.005, 1.0);
  const double middle = bounce(0.03, 1.0);
  EXPECT_GT(high, 0.75);
  EXPECT_LT(high, 0.97);
  EXPECT_GT(middle, 0.25);
  EXPECT_LT(middle, 0.65);
  EXPECT_LT(bounce(0.5, 1.0), 0.02);
  EXPECT_GT(bounce(0.03, 0.0), middle);  // without the film
}

}  // namespace
}  // namespace grouser
