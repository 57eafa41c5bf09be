// SPDX-License-Identifier: BSD-3-Clause
#include "base/time_step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/stiffness_scale.hpp"

namespace grouser {
namespace {

// Ten grains deep: equal grains of 10 mm but for a hair, so that numbers can be checked by hand.
const char* const kWheel = R"(
box: {length: 1 m, width: 50 cm, depth: 20 cm}
grains:
  density: 2650 kg/m3
  size_curve: [{diameter: 10 mm, finer: 0}, {diameter: 10.001 mm, finer: 1}]
contact:
  grain_grain: {restitution: 0.5, friction: 0.5}
  grain_box: {restitution: 0.5, friction: 0.3}
bed: {depth: 10 cm}
wheel:
  diameter: 40 cm
  width: 10 cm
  load: 100 N
  forward_speed: 1 m/s
  travel: 40 cm
  average_travel: 10 cm
)";

Case wheel_case() {
  std::vector<Problem> problems;
  const Case input = read_case(parse_yaml(kWheel, "case.yaml"), problems);
  for (const Problem& one : problems) ADD_FAILURE() << one.text();
  return input;
}

std::string problems_of(const Case& input) {
  std::vector<Problem> problems;
  read_case(write_case(input), problems);
  std::string text;
  for (const Problem& one : problems) text += one.text() + "\n";
  return text;
}

std::string warnings_of(const Case& input) {
  std::string text;
  for (const Problem& one : case_warnings(YamlNode{}, input)) text += one.text() + "\n";
  return text;
}

TEST(Collision, LastsAndPressesAsAnIntegratedHertzContactDoes) {
  for (const double speed : {0.01, 0.5, 3.0}) {
    Case input = wheel_case();
    input.wheel.forward_speed = 0.5 * speed;  // forward and rim speed add up
    const Impact collision = shortest_collision(input);
    EXPECT_DOUBLE_EQ(collision.speed, speed);
    EXPECT_EQ(collision.pair, "two grains");
    const double r = 5e-3;
    const double mass = 0.5 * 2650.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r;
    const double stiffness = 4.0 / 3.0 * 50e6 / (2.0 * (1.0 - 0.0625)) * std::sqrt(0.5 * r);
    const double dt = collision.time / 1e5;
    double overlap = 0.0;
    double largest = 0.0;
    double v = speed;
    double time = 0.0;
    do {
      v -= dt * stiffness * overlap * std::sqrt(overlap) / mass;
      overlap += dt * v;
      largest = std::max(largest, overlap);
      time += dt;
    } while (overlap > 0.0);
    // The published factor 2.87 has three digits.
    EXPECT_NEAR(collision.time / time, 1.0, 2e-3) << speed;
    // The largest overlap is that on the box: twice the mass and radius give 2^(1/5).
    EXPECT_NEAR(collision.overlap / (std::pow(2.0, 0.2) * largest / r), 1.0, 1e-3) << speed;
  }
}

TEST(Collision, WithAStifferBodyIsShorter) {
  Case input = wheel_case();
  const double soft = shortest_collision(input).time;
  input.wheel.solid.young_modulus = 200e9;
  EXPECT_EQ(shortest_collision(input).pair, "a grain and the wheel");
  EXPECT_LT(shortest_collision(input).time, soft);
  input.box.solid.young_modulus = 400e9;
  EXPECT_EQ(shortest_collision(input).pair, "a grain and the box");
}

TEST(FastestSpeed, IsTheFallOfABedAndForwardAndRimSpeedOfAWheel) {
  Case input = wheel_case();
  // 57 300 grains of 0.5236 cm3 in layers of 99 x 49 cells (10.001 mm each): 12 layers.
  EXPECT_NEAR(fastest_speed(bed_case(input)), std::sqrt(2.0 * 9.81 * 0.12), 1e-3);
  EXPECT_DOUBLE_EQ(fastest_speed(input), 2.0);
  input.wheel.slip = 0.5;
  EXPECT_DOUBLE_EQ(fastest_speed(input), 3.0);
  input.wheel.drive = "rim_speed";
  input.wheel.rim_speed = -4.0;
  EXPECT_DOUBLE_EQ(fastest_speed(input), 5.0);
  input.wheel.drive = "towed";
  EXPECT_DOUBLE_EQ(fastest_speed(input), 2.0);
}

TEST(AutomaticStep, IsTheSmallerOfBothSharesAndSaysWhichOneDecided) {
  Case input = wheel_case();
  EXPECT_EQ(time_step_of(input), 0.2 * rayleigh_time(input));
  EXPECT_NE(time_step_text(input).find("decided by the Rayleigh time: 0.2 of the Rayleigh time"),
            std::string::npos)
      << time_step_text(input);
  input.wheel.forward_speed = 20.0;
  EXPECT_EQ(time_step_of(input), shortest_collision(input).time / 8.0);
  EXPECT_LT(time_step_of(input), 0.2 * rayleigh_time(input));
  EXPECT_NE(time_step_text(input).find("decided by the shortest collision"), std::string::npos);
  EXPECT_NE(time_step_text(input).find("0.125 of the shortest collision"), std::string::npos);
  EXPECT_EQ(warnings_of(input), "");
  input.numerics.time_step = 1e-6;
  EXPECT_NE(time_step_text(input).find("decided by numerics.time_step"), std::string::npos);
}

TEST(AutomaticStep, IsShorterWhereDampingIsStifferThanTheSpring) {
  Case input = wheel_case();
  EXPECT_EQ(collision_steps(input), 8.0);
  input.contact.grain_wheel.restitution = 0.05;
  EXPECT_EQ(collision_steps(input), 11.0);
  EXPECT_EQ(collision_steps(bed_case(input)), 8.0);
  input.contact.grain_grain.restitution = 0.01;
  EXPECT_EQ(collision_steps(input), 29.0);
  EXPECT_EQ(time_step_of(input), shortest_collision(input).time / 29.0);
  input.numerics.time_step = 0.057 * shortest_collision(input).time;
  EXPECT_NE(warnings_of(input).find("over 0.0552 of it contacts may gain energy"),
            std::string::npos)
      << warnings_of(input);
}

TEST(GivenStep, LongerThanTheShortestCollisionIsRefusedAndOverAFifthOfItWarnedOf) {
  // A rigid box, hit fast: the one collision that is shorter than the grain's Rayleigh time.
  Case input = wheel_case();
  input.box.solid.young_modulus = 2000e9;
  input.grains.solid.poisson_ratio = 0.45;
  input.wheel.forward_speed = 60.0;
  const double collision = shortest_collision(input).time;
  input.numerics.time_step = 0.19 * collision;
  EXPECT_EQ(warnings_of(input).find("of the shortest collision"), std::string::npos);
  input.numerics.time_step = 0.21 * collision;
  EXPECT_NE(warnings_of(input).find("numerics.time_step: makes the time step 0.21 of the shortest "
                                    "collision, "),
            std::string::npos)
      << warnings_of(input);
  input.numerics.time_step = 0.99 * collision;
  EXPECT_EQ(problems_of(input).find("longer than the shortest collision"), std::string::npos);
  input.numerics.time_step = 1.01 * collision;
  EXPECT_NE(problems_of(input).find("longer than the shortest collision"), std::string::npos);
}

TEST(GivenStep, IsJudgedByTheBedsFallToo) {
  Case input = wheel_case();
  input.wheel.forward_speed = 1e-3;
  input.numerics.time_step = 0.25 * shortest_collision(bed_case(input)).time;
  EXPECT_NE(warnings_of(input).find("0.25 of the shortest collision"), std::string::npos)
      << warnings_of(input);
}

// Slips of units: each ends a run in its first steps or keeps it from making one.
TEST(Case, SpeedsThatPushGrainsThroughEachOtherAreRefused) {
  Case input = wheel_case();
  input.wheel.forward_speed = 1e6;
  EXPECT_NE(problems_of(input).find("wheel: grains that meet at 2e+06 m/s would overlap by"),
            std::string::npos);
  input = wheel_case();
  input.gravity = 1e12;
  EXPECT_NE(problems_of(input).find("grains: grains that meet at"), std::string::npos);
  for (const double density : {1e300, 1e-320}) {
    input = wheel_case();
    input.grains.density = density;
    EXPECT_NE(problems_of(input).find("grains: come to a time step of"), std::string::npos)
        << problems_of(input);
  }
}

TEST(Case, MoreGrainsThanAnyMachineHoldsAreRefused) {
  Case input = wheel_case();
  input.grains.size_curve = {{1e-9, 0.0}, {2e-9, 1.0}};
  EXPECT_NE(problems_of(input).find("grains.size_curve: comes to 1.53e+25 grains in the bed"),
            std::string::npos)
      << problems_of(input);
  // The publication's 36 million grains are far from it.
  input.grains.size_curve = {{0.8e-3, 0.0}, {1e-3, 1.0}};
  EXPECT_EQ(problems_of(input), "");
}

TEST(Case, MoreStepsThanAnyMachineEndsAreRefused) {
  Case input = wheel_case();
  input.box.solid.young_modulus = input.grains.solid.young_modulus = 1e36;
  input.wheel.solid.young_modulus = 1e36;
  EXPECT_NE(problems_of(input).find("numerics: comes to "), std::string::npos)
      << problems_of(input);
  // The hardest of real solids, diamond, is far from it.
  input.box.solid.young_modulus = input.grains.solid.young_modulus = 1.2e12;
  input.wheel.solid.young_modulus = 1.2e12;
  EXPECT_EQ(problems_of(input), "");
}

TEST(StiffnessScale, ActsAsLowerYoungsModuliOfAllSolids) {
  Case scaled = wheel_case();
  scaled.box.solid.young_modulus = 1e9;
  scaled.wheel.solid.young_modulus = 3e9;
  Case softer = scaled;
  scaled.contact.stiffness_scale = 0.01;
  for (SolidCase* solid : {&softer.grains.solid, &softer.box.solid, &softer.wheel.solid})
    solid->young_modulus *= 0.01;
  EXPECT_DOUBLE_EQ(rayleigh_time(scaled), rayleigh_time(softer));
  EXPECT_EQ(shortest_collision(scaled).time, shortest_collision(softer).time);
  EXPECT_DOUBLE_EQ(expected_overlap(scaled).overlap, expected_overlap(softer).overlap);
}

TEST(StiffnessScale, BelowOneIsWarnedOfWithStepAndOverlap) {
  Case input = wheel_case();
  EXPECT_EQ(warnings_of(input), "");
  input.contact.stiffness_scale = 0.01;
  // The Rayleigh time would allow ten times the step; the collision, 0.01^(-2/5) longer, a bit
  // less. p = 100 N / (10 cm * 10 cm) = 10 kPa; E* = 267 kPa; 2 (1.5 pi 10 / (6 * 0.6 *
  // 267))^(2/3).
  EXPECT_EQ(warnings_of(input),
            "contact.stiffness_scale: makes every contact 0.01 as stiff as its solids: time step "
            "0.000381 s instead of 3.94e-05 s, mean overlap about 0.268 of a radius instead of "
            "0.0124 under 10 kPa; compare with the mean_overlap of the outcome, the max_overlap of "
            "series.csv and with a stiffer "
            "run\n");
}

TEST(ContentKey, OfACaseFromBeforeStaysUnlessTheStepIsAnother) {
  Case input = wheel_case();
  const std::string key = content_key(input);
  EXPECT_EQ(key, "1174220bc3f15d2b");  // made before contacts had a say in the step
  Case scaled = input;
  scaled.contact.stiffness_scale = 0.5;
  EXPECT_NE(content_key(scaled), key);
  // The shortest collision's step is the same run as that step given.
  Case fast = input;
  fast.wheel.forward_speed = 20.0;
  Case given = fast;
  given.numerics.time_step = time_step_of(fast);
  EXPECT_EQ(content_key(fast), content_key(given));
  given.numerics.time_step = 0.2 * rayleigh_time(fast);
  EXPECT_NE(content_key(fast), content_key(given));
}

}  // namespace
}  // namespace grouser
