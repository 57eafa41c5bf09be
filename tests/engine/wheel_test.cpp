// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "engine/app/setup.hpp"
#include "engine/core/state_io.hpp"
#include "engine/terrain/bed.hpp"
#include "engine/terrain/wheel.hpp"

namespace grouser {
namespace {

// A toy of the main job: a 14 cm wheel of 30 N on about a thousand grains.
Case toy() {
  Case input;
  input.box.length = 0.30;
  input.box.width = 0.16;
  input.box.depth = 0.10;
  input.grains.size_curve = {{9e-3, 0.0}, {14e-3, 1.0}};
  input.grains.solid = {1e7, 0.25};
  input.box.solid = input.grains.solid;
  input.contact.rolling = "elastic_plastic";
  input.contact.grain_grain = {0.4, 0.5, 0.2};
  input.contact.grain_box = {0.4, 0.5, 0.2};
  input.contact.grain_wheel = {0.4, 0.6, 0.1};
  input.bed.depth = 0.05;
  input.bed.preparation_friction = 0.3;
  input.has_wheel = true;
  WheelCase& w = input.wheel;
  w.diameter = 0.14;
  w.width = 0.06;
  w.facets = 60;
  w.solid = input.grains.solid;
  w.load = 30.0;
  w.inertia = 2e-3;
  w.start = 0.35;
  w.settle_time = 0.1;
  w.settle_speed = 0.2;
  w.ramp_time = 0.01;
  w.forward_speed = 0.4;
  w.travel = 0.05;
  w.average_travel = 0.02;
  return input;
}

// The bed, settled once for all tests.
const State& bed() {
  static const State state = [] {
    Case input = bed_case(toy());
    World world = make_world(Communicator::alone(), input);
    fill(world, input);
    const auto steps = static_cast<int>(0.5 / world.settings().time_step);
    for (int i = 0; i < steps; ++i) world.step();
    EXPECT_LT(world.kinetic_energy() / static_cast<double>(world.particle_count()),
              1e3 * settled_energy(input));
    State saved;
    world.save_state(saved);
    return saved;
  }();
  return state;
}

// Mean of a force in time and how far it may be off by chance: the standard error of the means of
// blocks that follow each other.
struct Mean {
  double value = 0.0;
  double error = 0.0;
};

Mean mean_of(const std::vector<double>& samples, std::size_t blocks) {
  const std::size_t length = samples.size() / blocks;
  std::vector<double> means(blocks, 0.0);
  for (std::size_t i = 0; i < blocks * length; ++i)
    means[i / length] += samples[i] / static_cast<double>(length);
  Mean out;
  for (const double mean : means) out.value += mean / static_cast<double>(blocks);
  double squares = 0.0;
  for (const double mean : means) squares += (mean - out.value) * (mean - out.value);
  out.error = std::sqrt(squares / static_cast<double>(blocks * (blocks - 1)));
  return out;
}

struct Drive {
  WheelSample settled;  // mean over the last tenth of the settling
  WheelSample driven;   // mean over the last 40 % of the way
  double spin_start = 0.0;
  double spin_end = 0.0;
  // Vertical force of every step, over the last half of the settling and the last 60 % of the way,
  // and the wheel's vertical speed at the ends of the latter.
  std::vector<double> standing;
  std::vector<double> rolling;
  double rise_start = 0.0;
  double rise_end = 0.0;
  double time_step = 0.0;
};

Drive drive(const Case& input) {
  World world = make_world(Communicator::alone(), input);
  world.load_state(bed());
  Wheel wheel(input, world, kWheelBody);
  wheel.place();
  const double dt = world.settings().time_step;
  const double end = run_duration(input);
  const double settle = input.wheel.settle_time;
  const double window = end - 0.4 * (end - settle);
  Drive out;
  out.time_step = dt;
  bool took_settled = false;
  bool took_window = false;
  for (double time = 0.0; time < end; time += dt) {
    if (!took_settled && time > 0.9 * settle) {
      wheel.take_sample();
      took_settled = true;
    }
    if (!took_window && time > window) {
      wheel.take_sample();
      out.spin_start = world.body(kWheelBody).motion.spin;
      took_window = true;
    }
    const World::StepResult result = world.step();
    EXPECT_EQ(result.fault, Fault::kNone);
    wheel.advance(time + dt, result.max_overlap);
    const double force = world.load(kWheelBody).force_z.value();
    if (time > 0.5 * settle && time + 2.0 * dt < settle) out.standing.push_back(force);
    if (time > end - 0.6 * (end - settle)) {
      out.rise_end = world.body(kWheelBody).motion.velocity.z;
      // The speed before this force acted is the one that the step before left.
      if (out.rolling.empty()) out.rise_start = out.rise_end - dt * (force - 30.0) * 9.81 / 30.0;
      out.rolling.push_back(force);
    }
    if (took_settled && !took_window && time + 2.0 * dt > settle &&
        out.settled.vertical_force == 0.0)
      out.settled = wheel.take_sample();
  }
  out.driven = wheel.take_sample();
  out.spin_end = world.body(kWheelBody).motion.spin;
  return out;
}

TEST(Wheel, StandsOnTheBedWithItsLoad) {
  Case input = toy();
  input.wheel.settle_time = 0.4;
  const Drive result = drive(input);
  const Mean force = mean_of(result.standing, 8);
  // At rest the soil carries the load within what its force scatters by. When hardly anything moves
  // any more, sinking at 0.2 mm/s still leaves a thousandth to the damper of 0.2 m/s.
  EXPECT_LT(std::abs(force.value - 30.0), std::max(3.0 * force.error, 1e-3 * 30.0));
  EXPECT_LT(force.error, 0.01 * 30.0);  // or the line above would hold for anything
  EXPECT_NEAR(result.settled.pull / 30.0, 0.0, 0.1);
  EXPECT_EQ(result.settled.spin, 0.0);
}

TEST(Wheel, KeepsItsLoadOnTheMeanWhileDriving) {
  Case input = toy();
  input.wheel.slip = 0.2;
  input.wheel.travel = 0.12;
  const Drive result = drive(input);
  // Riding over single grains of a tenth of its diameter makes the force swing; an eighth of the
  // window is about the way across one of them.
  const Mean force = mean_of(result.rolling, 8);
  EXPECT_LT(std::abs(force.value - 30.0), 3.0 * force.error);
  EXPECT_LT(force.error, 0.15 * 30.0);  // or the line above would hold for anything
  // Free to rise and fall, the wheel turns all that is not load into vertical momentum.
  double impulse = 0.0;
  for (const double sample : result.rolling) impulse += (sample - 30.0) * result.time_step;
  EXPECT_NEAR(impulse, 30.0 / 9.81 * (result.rise_end - result.rise_start), 1e-9 * 30.0);
  EXPECT_NEAR(result.driven.forward_speed, 0.4, 1e-9);
  EXPECT_NEAR(result.driven.slip(0.07), 0.2, 1e-9);
  EXPECT_NEAR(result.driven.spin, 0.4 / (0.07 * 0.8), 1e-6);
}

TEST(Wheel, ADrivenWheelIsPushedForwardAndALockedOneHeldBack) {
  Case driven = toy();
  driven.wheel.slip = 0.5;
  const WheelSample fast = drive(driven).driven;
  EXPECT_GT(fast.gross_tractive_effort, 0.0);  // the soil resists the turning: torque must be given
  Case locked = toy();
  locked.wheel.drive = "rim_speed";
  locked.wheel.rim_speed = 0.0;
  const WheelSample held = drive(locked).driven;
  EXPECT_LT(held.gross_tractive_effort, 0.0);  // the soil turns the wheel forward
  EXPECT_LT(held.pull, 0.0);
  EXPECT_GT(fast.pull, held.pull + 0.2 * 30.0);
  // Motion resistance is what the soil takes of the gross effort.
  EXPECT_NEAR(fast.motion_resistance(), fast.gross_tractive_effort - fast.pull, 1e-12);
  EXPECT_DOUBLE_EQ(held.skid(0.07), 1.0);
  EXPECT_TRUE(std::isnan(held.slip(0.07)));
}

TEST(Wheel, ATowedWheelTurnsByTheSoilAlone) {
  Case input = toy();
  input.wheel.drive = "towed";
  const Drive result = drive(input);
  EXPECT_LT(result.driven.pull, 0.0);
  EXPECT_GT(result.driven.spin, 0.0);
  // No torque on the axle: the mean contact moment is the gain of angular momentum.
  const double window = 0.4 * (run_duration(input) - input.wheel.settle_time);
  const double moment = input.wheel.inertia * (result.spin_end - result.spin_start) / window;
  EXPECT_NEAR(-result.driven.gross_tractive_effort * 0.07, moment, 0.02 * 30.0 * 0.07);
}

TEST(Wheel, TorqueDrivesItForward) {
  Case input = toy();
  input.wheel.drive = "torque";
  input.wheel.torque = 0.3;
  const WheelSample pushed = drive(input).driven;
  EXPECT_GT(pushed.forward_speed, 0.01);
  EXPECT_GT(pushed.spin, 0.0);
  input.wheel.torque = -0.3;
  EXPECT_LT(drive(input).driven.forward_speed, -0.01);
}

TEST(Wheel, SaysWhenItMeetsTheBox) {
  const Case input = toy();
  World world = make_world(Communicator::alone(), input);
  Wheel wheel(input, world, kWheelBody);
  Vec3& axle = world.body(kWheelBody).motion.position;
  axle = {0.15, 0.08, 0.0701};
  EXPECT_EQ(wheel.fault(), "");
  axle.z = 0.0699;
  EXPECT_NE(wheel.fault().find("floor"), std::string::npos);
  for (const double x : {0.01, 0.29}) {
    axle = {x, 0.08, 0.1};
    EXPECT_NE(wheel.fault().find("end wall"), std::string::npos);
  }
}

TEST(Wheel, ItsStateSurvivesACheckpoint) {
  const Case input = toy();
  World world = make_world(Communicator::alone(), input);
  world.load_state(bed());
  Wheel wheel(input, world, kWheelBody);
  wheel.place();
  for (int i = 1; i <= 50; ++i) {
    world.step();
    wheel.advance(i * world.settings().time_step, 0.01);
  }
  State state;
  wheel.save_state(state);
  Wheel other(input, world, kWheelBody);
  other.load_state(state);
  const WheelSample a = wheel.take_sample();
  const WheelSample b = other.take_sample();
  EXPECT_EQ(a.vertical_force, b.vertical_force);
  EXPECT_EQ(a.sinkage, b.sinkage);
  EXPECT_EQ(a.travel, b.travel);
  EXPECT_EQ(a.max_overlap, b.max_overlap);
}

// A power of two, so that scaling rounds nothing.
TEST(StiffnessScale, GivesTheBitsOfSofterGrainsBoxAndWheel) {
  const auto hash_after = [](const Case& input) {
    World world = make_world(Communicator::alone(), input);
    fill(world, input);
    // In the filling, so that grains touch it from the first step.
    world.body(kWheelBody).motion.position = {0.1, 0.08, 0.1};
    for (int i = 0; i < 300; ++i) world.step();
    EXPECT_GT(world.contacts(), 0);
    State state;
    world.save_state(state);
    std::string hashes;
    for (const StateTable& table : state)
      hashes += std::to_string(hash_state(world.ranks(), {table})) + " ";
    return hashes;
  };
  Case scaled = toy();
  scaled.numerics.time_step = 1e-4;
  scaled.box.solid.young_modulus = 3e7;
  scaled.wheel.solid.young_modulus = 7e7;
  Case softer = scaled;
  scaled.contact.stiffness_scale = 0.125;
  EXPECT_NE(hash_after(scaled), hash_after(softer));
  softer.grains.solid.young_modulus *= 0.125;
  const Case grains_only = softer;
  softer.box.solid.young_modulus *= 0.125;
  softer.wheel.solid.young_modulus *= 0.125;
  EXPECT_EQ(hash_after(scaled), hash_after(softer));
  EXPECT_NE(hash_after(scaled), hash_after(grains_only));
}

}  // namespace
}  // namespace grouser
