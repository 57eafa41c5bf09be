// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/case.hpp"
#include "base/time_step.hpp"
#include "engine/coupling/outer_forces.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {
namespace {

constexpr double kPi = std::numbers::pi;

// Grains of 8 mm in cells of 1 mm, in a liquid. Run under mpirun with any number of ranks.
const char* const kTank = R"(
box: {length: 24 mm, width: 24 mm, depth: 32 mm}
placed:
  duration: 1 s
  grains:
    - {diameter: 8 mm, x: 11.7 mm, y: 12.1 mm, z: 22.3 mm}
grains: {density: 2500 kg/m3, solid: {young_modulus: 1 MPa}}
contact:
  grain_grain: {restitution: 0.9, friction: 0.3}
  grain_box: {restitution: 0.9, friction: 0.3}
fluid:
  mode: resolved
  density: 1000 kg/m3
  viscosity: 100 mPa s
  lattice: {cell: 1 mm, speed: 0.1 m/s, mach: 0.1}
)";

Case tank(const std::string& from = "", const std::string& to = "") {
  std::string text = kTank;
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  std::vector<Problem> problems;
  Case input = read_case(parse_yaml(text, "tank"), problems);
  for (const Problem& problem : problems) ADD_FAILURE() << problem.text();
  return input;
}

// Twelve of them, of several sizes, on their way.
Case crowd() {
  std::string grains;
  for (int k = 0; k < 12; ++k)
    grains += "    - {diameter: " + std::to_string(6.0 + 0.1 * k) +
              " mm, x: " + std::to_string(4.5 + 7.5 * (k % 3)) +
              " mm, y: " + std::to_string(6.0 + 11.0 * (k / 3 % 2)) +
              " mm, z: " + std::to_string(5.0 + 9.0 * (k / 6)) +
              " mm, velocity_x: 5 cm/s, velocity_z: -5 cm/s, spin_y: 2 rad/s, spin_z: -1 rad/s}\n";
  const std::string one = "    - {diameter: 8 mm, x: 11.7 mm, y: 12.1 mm, z: 22.3 mm}\n";
  return tank(one, grains);
}

// Grains in a box of fluid, as the engine runs them.
class Tank {
 public:
  Tank(const Communicator& ranks, const Case& input, bool with_wheel = false)
      : world_(ranks, settings(input)) {
    add_box(world_, {0.9, 0.3, 0.0});
    if (with_wheel) {
      WheelCase wheel;
      wheel.diameter = 12e-3;
      wheel.width = 8e-3;
      wheel.facets = 30;
      wheel_ = world_.add_body("wheel", wheel_mesh(wheel), kTestSolid, {0.9, 0.3, 0.0}, true);
      world_.body(wheel_).motion = {{12e-3, 12e-3, 9e-3}, 0.3, {0.05, 0.0, -0.02}, 8.0};
    }
    outer_ = std::make_unique<OuterForces>(input, world_);
    std::int64_t id = 0;
    for (const PlacedGrain& g : input.placed.grains) {
      Particle p;
      p.id = id++;
      p.radius = 0.5 * g.diameter;
      p.mass = input.grains.density * kPi / 6.0 * g.diameter * g.diameter * g.diameter;
      p.position = {g.x, g.y, g.z};
      p.velocity = {g.velocity_x, g.velocity_y, g.velocity_z};
      p.spin = {g.spin_x, g.spin_y, g.spin_z};
      if (world_.owns(p.position)) world_.add_particle(p);
    }
  }

  void run(std::int64_t steps) {
    for (std::int64_t i = 0; i < steps; ++i, ++step_) {
      outer_->announce(step_, 0.0, false);
      ASSERT_EQ(world_.step().fault, Fault::kNone);
      outer_->load_bodies();
      if (wheel_ == 0) continue;
      BodyMotion& motion = world_.body(wheel_).motion;
      motion.position += world_.settings().time_step * motion.velocity;
      motion.angle += world_.settings().time_step * motion.spin;
    }
  }
  State state(const StatePiece& piece = {}) const {
    State state;
    world_.save_state(state, piece);
    outer_->save_state(state, piece);
    return state;
  }
  std::uint64_t hash() const { return hash_state(world_.ranks(), state()); }
  void load(const State& state, std::int64_t step) {
    world_.load_state(state);
    outer_->load_state(state);
    step_ = step;
  }
  std::int64_t substeps() { return outer_->lattice()->scale().substeps; }
  const ResolvedFlow& lattice() { return *outer_->lattice(); }
  World& world() { return world_; }
  const Particle& grain() const { return world_.particles()[0]; }

 private:
  static WorldSettings settings(const Case& input) {
    WorldSettings s = small_settings();
    s.low = {0.0, 0.0, 0.0};
    s.high = {input.box.length, input.box.width, 0.2};
    s.top = input.box.depth;
    s.gravity = input.gravity;
    s.time_step = time_step_of(input);
    s.largest_radius = 0.5 * input.placed.largest();
    s.skin = 0.25 * s.largest_radius;
    return s;
  }

  World world_;
  std::unique_ptr<OuterForces> outer_;
  std::int64_t step_ = 0;
  std::size_t wheel_ = 0;  // 0 without
};

TEST(ResolvedInvariance, GrainsAndLatticeAreTheSameBitForBitOnAnyNumberOfRanks) {
  for (const bool with_wheel : {false, true}) {
    const Case input = with_wheel ? tank() : crowd();
    Tank together(Communicator(), input, with_wheel);
    Tank alone(Communicator::alone(), input, with_wheel);
    ASSERT_GT(together.substeps(), 1);
    for (int leg = 0; leg < 2; ++leg) {
      const std::int64_t steps = 10 * together.substeps() + 1;
      together.run(steps);
      if (Communicator().rank() == 0) alone.run(steps);
      const auto expected = static_cast<std::uint64_t>(
          Communicator().from_first(static_cast<std::int64_t>(alone.hash())));
      ASSERT_EQ(together.hash(), expected) << "after leg " << leg;
    }
    EXPECT_GT(together.lattice().flow().totals().max_speed_lu, 1e-3);
  }
}

TEST(ResolvedInvariance, ARestartBetweenTwoStepsOfTheFluidChangesNoBit) {
  for (const bool with_wheel : {false, true}) {
    const Case input = with_wheel ? tank() : crowd();
    Tank straight(Communicator(), input, with_wheel);
    const std::int64_t cut = 6 * straight.substeps() + straight.substeps() / 2;
    straight.run(cut);
    Tank resumed(Communicator(), input, with_wheel);
    resumed.load(straight.state(), cut);
    EXPECT_EQ(resumed.hash(), straight.hash());
    straight.run(cut);
    resumed.run(cut);
    EXPECT_EQ(resumed.hash(), straight.hash());
  }
}

TEST(Resolved, AWheelIsHeldBackAndMovesTheFluid) {
  if (Communicator().rank() > 0) return;  // one is enough
  Tank tank(Communicator::alone(), ::grouser::tank(), true);
  tank.run(20 * tank.substeps());
  const BodyLoad load = tank.lattice().wheel_load();
  EXPECT_LT(load.force_x.value(), 0.0);
  EXPECT_LT(load.moment_y(), 0.0);
  // Buoyancy of the drum and drag on its way down are both upward.
  const double volume = 0.25 * kPi * 12e-3 * 12e-3 * 8e-3;
  EXPECT_GT(load.force_z.value(), 0.98 * 1000.0 * 9.81 * volume);
  EXPECT_GT(tank.lattice().flow().totals().momentum_lu.x, 0.0);
  EXPECT_LT(tank.lattice().flow().totals().momentum_lu.z, 0.0);
}

TEST(Resolved, MomentumOfGrainsAndFluidOutsideThemIsKept) {
  if (Communicator().rank() > 0) return;  // one is enough
  // Periodic on all sides and so light a pull that no wall is reached; contacts are with none.
  Case input = tank("mach: 0.1}",
                    "mach: 0.1, faces: {x_low: {kind: periodic}, x_high: {kind: "
                    "periodic}, y_low: {kind: periodic}, y_high: {kind: periodic}, "
                    "z_low: {kind: periodic}, z_high: {kind: periodic}}}");
  input.gravity = 1e-12;
  input.placed.grains[0].velocity_x = 0.03;
  input.placed.grains[0].velocity_z = -0.05;
  Tank tank(Communicator::alone(), input);
  const LatticeUnits units = tank.lattice().scale().units;
  const double cell_mass = units.density * std::pow(units.cell, 3);
  const double inside = 1000.0 * kPi / 6.0 * std::pow(8e-3, 3);
  const auto total = [&](const Vec3& before) {
    const Vec3 fluid =
        (cell_mass * units.cell / units.step) * tank.lattice().flow().totals().momentum_lu;
    return fluid + tank.grain().mass * tank.grain().velocity - inside * before;
  };
  const Vec3 first = total(tank.grain().velocity);
  for (int k = 0; k < 40; ++k) {
    const Vec3 before = tank.grain().velocity;
    tank.run(tank.substeps());
    // Some 1e-16 of each term for each step.
    ASSERT_LT(norm(total(before) - first), 1e-12 * norm(first)) << k;
  }
  EXPECT_LT(norm(tank.grain().velocity), 0.05);  // it has given away something
}

TEST(Resolved, AGrainThatFallsFreelyIsHeldBackByAddedMassAndHistory) {
  if (Communicator().rank() > 0) return;  // one is enough
  // Over a short time T from rest (m + C m') v = (m - m') g T, m' the fluid displaced, with C = 1/2
  // of added mass, 2/3 of 18/sqrt(pi) sqrt(nu T)/d of Basset's force and half of 18 nu T/d^2 of
  // Stokes' drag. Walls a diameter away add some 0.05. The error falls with the cell: 0.17 for 8
  // cells across, 0.08 for 16, which are here; lighter grains than the fluid are no worse.
  constexpr double kTime = 0.02;
  const double layer = std::sqrt(2e-5 * kTime) / 8e-3;
  const double expected =
      0.5 + 2.0 / 3.0 * 18.0 / std::sqrt(kPi) * layer + 0.5 * 18.0 * layer * layer;
  for (const double density : {700.0, 1200.0, 2500.0}) {
    Case input = tank("100 mPa s\n  lattice: {cell: 1 mm", "20 mPa s\n  lattice: {cell: 0.5 mm");
    input.grains.density = density;
    input.placed.grains[0].z = 16.3e-3;
    Tank tank(Communicator::alone(), input);
    tank.run(std::llround(kTime / time_step_of(input)));
    const double mean = -tank.grain().velocity.z / kTime;
    const double ratio = density / 1000.0;
    EXPECT_NEAR((ratio - 1.0) * 9.81 / mean - ratio, expected, 0.12) << density;
  }
}

}  // namespace
}  // namespace grouser
