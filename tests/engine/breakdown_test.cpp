// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "base/time_step.hpp"
#include "engine/app/breakdown.hpp"
#include "engine/app/setup.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {
namespace {

Case soft_sand() {
  Case input;
  input.numerics.time_step = small_settings().time_step;
  input.box.length = input.box.width = 0.1;
  input.grains.size_curve = {{6e-3, 0.0}, {10e-3, 1.0}};
  return input;
}

// What breaks when these grains take a step.
std::string broken_by(const std::vector<Particle>& grains, const Case& input = soft_sand()) {
  World world(Communicator(), small_settings());
  add_box(world, {0.5, 0.5, 0.0});
  for (const Particle& p : grains)
    if (p.id % world.ranks().size() == world.ranks().rank()) world.add_particle(p);
  return breakdown_of(world, world.step(), input).value_or("");
}

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nis missing from\n" << text;
}

const Particle kCalm = sphere(0, 4e-3, {0.02, 0.02, 0.02});

TEST(Breakdown, NothingIsWrongWithGrainsThatFall) { EXPECT_EQ(broken_by({kCalm}), ""); }

TEST(Breakdown, ANumberThatIsNoneIsTracedToItsGrain) {
  Particle lame = sphere(1, 4e-3, {0.07, 0.05, 0.2});
  lame.spin.y = NAN;
  lame.velocity.x = NAN;
  expect_parts(broken_by({kCalm, lame}),
               {"not a number: grain 1, which started at (0.07 0.05 0.2) m", "time step"});
  // Two at one place have no normal.
  Particle twin = kCalm;
  twin.id = 1;
  expect_parts(broken_by({kCalm, twin}), {"not a number: grain 0, ", "two grains at one place"});
}

TEST(Breakdown, AGrainThroughAWallIsNamedWithPlaceAndSpeed) {
  Particle fast = sphere(1, 4e-3, {0.097, 0.05, 0.2});
  fast.velocity.x = 2e3;
  expect_parts(broken_by({kCalm, fast}),
               {"a grain has left the box: grain 1 is at (0.107 0.05 0.2) m with (1.94e+03 0 ",
                "a higher box.depth", "shorter time step"});
}

TEST(Breakdown, AGrainThatIsThrownBeyondReasonIsNotBlamedOnWalls) {
  Particle thrown = sphere(1, 4e-3, {0.05, 0.05, 0.2});
  thrown.velocity.x = 1e12;
  expect_parts(broken_by({kCalm, thrown}),
               {"a grain has left the box: grain 1 ", "5e+06 m in one step: find what throws it"});
}

TEST(Breakdown, AGrainThatWouldPassASurfaceUnseenIsTooFast) {
  Particle fast = sphere(1, 4e-3, {0.05, 0.05, 0.2});
  fast.velocity.x = 610.0;  // 3.05 mm in a step of 5 us; the smallest radius is 3 mm
  expect_parts(broken_by({kCalm, fast}),
               {"a grain moves at 610 m/s, 0.00305 m in a step: more than the radius", "0.003 m"});
  fast.velocity.x = 590.0;
  EXPECT_EQ(broken_by({kCalm, fast}), "");
}

TEST(Breakdown, TheDeepestContactIsNamed) {
  const Particle on_it = sphere(1, 4e-3, {0.02, 0.02, 0.027});
  expect_parts(broken_by({kCalm, on_it, sphere(2, 4e-3, {0.06, 0.06, 0.0038})}),
               {"overlap 0.25 of a radius is over numerics.max_overlap 0.1: grain 0 at (0.02 0.02 ",
                "and grain 1; use stiffer grains"});
  expect_parts(broken_by({kCalm, sphere(2, 4e-3, {0.06, 0.06, 0.003}),
                          sphere(1, 4e-3, {0.06, 0.02, 0.003})}),
               {"grain 1 at (0.06 0.02 0.003) m and the box"});
}

// Grains between elastic walls without friction lose nothing: what they hold changes its kind only.
TEST(Survey, EnergyOfElasticGrainsStays) {
  WorldSettings settings = small_settings();
  settings.grain_grain = {1.0, 0.0, 0.0};
  settings.time_step = 1e-6;
  World world(Communicator(), settings);
  add_box(world, {1.0, 0.0, 0.0});
  for (const Particle& p : loose_column(243, 3))
    if (p.id % world.ranks().size() == world.ranks().rank()) world.add_particle(p);
  world.step();
  const World::Survey first = world.survey();
  double most_elastic = 0.0;
  for (int i = 0; i < 20000; ++i) {
    ASSERT_EQ(world.step().fault, Fault::kNone);
    if (i % 100 != 0) continue;
    const World::Survey now = world.survey();
    most_elastic = std::max(most_elastic, now.elastic);
    // A step is 1/200 of a collision or less; elastic forces and velocities are half a step apart.
    ASSERT_NEAR(now.total(), first.total(), 0.01 * now.elastic + 2e-4 * first.kinetic) << i;
  }
  EXPECT_GT(most_elastic, 0.02 * first.kinetic);  // or the line above shows little
}

TEST(Survey, MeanOverlapIsThatOfTheTouchingPairs) {
  World world(Communicator(), small_settings());
  for (const Particle& p :
       {sphere(0, 4e-3, {0.05, 0.05, 0.02}), sphere(1, 2e-3, {0.05, 0.05, 0.0259}),
        sphere(2, 4e-3, {0.0578, 0.05, 0.02}), sphere(3, 4e-3, {0.09, 0.05, 0.02})})
    if (p.id % world.ranks().size() == world.ranks().rank()) world.add_particle(p);
  world.step();
  EXPECT_NEAR(world.survey().mean_overlap, 0.5 * (0.1 / 2.0 + 0.2 / 4.0), 1e-9);
}

// A bed that takes steps of this share of its Rayleigh time.
Case stepping(double share_of_rayleigh) {
  Case input = soft_sand();
  input.box.depth = 0.1;
  input.bed.depth = 0.03;
  input.grains.solid = input.box.solid = {1e7, 0.25};
  input.contact.grain_grain = input.contact.grain_box = {0.5, 0.3, 0.0};
  input.numerics.time_step = share_of_rayleigh * rayleigh_time(input);
  return input;
}

struct Watched {
  int noticed_at = 0;    // step of the alarm, 0 = none
  int broken_at = 0;     // step at which overlaps, speeds or numbers break the run, 0 = none
  double highest = 0.0;  // rise over elastic energy
};

Watched watch(World& world, const Case& input, int steps) {
  EnergyLedger ledger(world.ranks());
  Watched out;
  for (int i = 1; i <= steps && out.noticed_at == 0; ++i) {
    const World::StepResult result = world.step();
    ledger.add_work(world);
    if (breakdown_of(world, result, input)) {
      out.broken_at = i;
      return out;
    }
    if (i % EnergyLedger::kInterval != 0) continue;
    const World::Survey survey = world.survey();
    if (ledger.rises(survey)) out.noticed_at = i;
    out.highest = std::max(out.highest, ledger.rise() / survey.elastic);
  }
  return out;
}

TEST(EnergyLedger, NoticesABedThatHeatsUpBeforeItFlies) {
  const Case good = stepping(0.1);
  World calm = make_world(Communicator(), good);
  fill(calm, good);
  // Falling, bouncing and coming to rest, energy only falls.
  const Watched settling = watch(calm, good, 12000);
  EXPECT_EQ(settling.noticed_at, 0);
  EXPECT_LT(settling.highest, 0.1 * EnergyLedger::kShare);
  State state;
  calm.save_state(state);
  const auto go_on = [&](double share) {
    const Case input = stepping(share);
    World world = make_world(Communicator(), input);
    world.load_state(state);
    return watch(world, input, 8000);
  };
  // With the last of these overlaps stay small for thousands of steps before the bed explodes; with
  // much longer ones it does so in a few steps, which overlaps tell at once.
  EXPECT_EQ(go_on(0.3).noticed_at, 0);
  const Watched heating = go_on(1.0);
  EXPECT_GT(heating.noticed_at, 0);
  EXPECT_EQ(heating.broken_at, 0);
  EXPECT_GT(go_on(1.4).broken_at, 0);
}

// What a drum does to grains at rest is work, not energy from nothing.
TEST(EnergyLedger, CountsTheWorkOfBodies) {
  WorldSettings settings = small_settings();
  settings.grain_grain = {1.0, 0.0, 0.0};
  settings.gravity = 0.0;
  settings.time_step = 1e-6;
  World world(Communicator(), settings);
  WheelCase drum;
  drum.diameter = 0.04;
  drum.width = 0.04;
  drum.facets = 36;
  const std::size_t body =
      world.add_body("drum", wheel_mesh(drum), kTestSolid, {1.0, 0.5, 0.0}, true);
  BodyMotion& motion = world.body(body).motion;
  motion.position = {0.03, 0.05, 0.1};
  motion.velocity.x = 1.0;
  motion.spin = 20.0;
  const Particle grain = sphere(0, 4e-3, {0.0545, 0.05, 0.1});
  if (world.owns(grain.position)) world.add_particle(grain);
  EnergyLedger ledger(world.ranks());
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(world.step().fault, Fault::kNone);
    ledger.add_work(world);
    motion.position += settings.time_step * motion.velocity;
    motion.angle += settings.time_step * motion.spin;
  }
  const World::Survey after = world.survey();
  ASSERT_GT(after.kinetic, 0.5 * grain.mass);  // it was struck
  // To first order in the step, over a collision of some hundred steps.
  EXPECT_NEAR(after.total(), ledger.work(), 0.02 * after.kinetic);
}

TEST(EnergyLedger, ItsStateSurvivesACheckpoint) {
  EnergyLedger ledger{Communicator()};
  World::Survey survey;
  for (const double kinetic : {2.0, 1.0, 3.0}) {
    survey.kinetic = kinetic;
    ledger.rises(survey);
  }
  State state;
  ledger.save_state(state);
  EnergyLedger other{Communicator()};
  other.load_state(state);
  survey.kinetic = 1.5;
  EXPECT_FALSE(other.rises(survey));
  EXPECT_EQ(other.rise(), 0.5);
  survey.kinetic = 2.5;
  EXPECT_TRUE(other.rises(survey));
}

}  // namespace
}  // namespace grouser
