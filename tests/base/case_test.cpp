// SPDX-License-Identifier: BSD-3-Clause
#include "base/case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/time_step.hpp"

namespace grouser {
namespace {

const char* const kGood = R"(
box: {length: 1.2 m, width: 53 cm, depth: 22 cm}
grains:
  density: 2650 kg/m3
  size_curve: [{diameter: 0.76 mm, finer: 0}, {diameter: 2.29 mm, finer: 1}]
  coarse_graining: 12
contact:
  grain_grain: {restitution: 0.5, friction: 0.5}
  grain_box: {restitution: 0.5, friction: 0.3}
bed: {depth: 20 cm}
wheel:
  diameter: 71.27 cm
  width: 17.78 cm
  load: 1922 N
  forward_speed: 1.67 m/s
  travel: 40 cm
  average_travel: 10 cm
)";

std::vector<Problem> problems_of(const std::string& text) {
  std::vector<Problem> problems;
  read_case(parse_yaml(text, "case.yaml"), problems);
  return problems;
}

TEST(Case, AGoodCaseHasNoProblems) {
  for (const Problem& problem : problems_of(kGood)) ADD_FAILURE() << problem.text();
}

// kGood's smallest grain: r = 4.56 mm, rho = 2650, G = 50 MPa / 2.5, nu = 0.25.
const double kGoodRayleighTime = std::numbers::pi * 4.56e-3 * std::sqrt(2650.0 / 2e7) / 0.917375;

TEST(Case, TimeStepIsTheAskedShareOfTheRayleighTime) {
  std::vector<Problem> problems;
  Case input = read_case(parse_yaml(kGood, "a"), problems);
  EXPECT_NEAR(rayleigh_time(input), kGoodRayleighTime, 1e-12);
  EXPECT_NEAR(time_step_of(input), 0.2 * kGoodRayleighTime, 1e-12);
  input.numerics.time_step = 1e-6;
  EXPECT_EQ(time_step_of(input), 1e-6);
  EXPECT_EQ(rayleigh_time(Case{}), 0.0);
}

// 1.80e-4 s is kGood's Rayleigh time.
TEST(Case, ATimeStepOverTheRayleighTimeIsRefusedAtItsPlace) {
  const auto problems = problems_of(std::string(kGood) + "numerics: {time_step: 0.181 ms}\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].text(),
            "case.yaml:18:23: numerics.time_step: is 0.000181 s, over the Rayleigh time of the "
            "smallest grain, 0.00018 s: contacts would gain energy until the run breaks down; give "
            "5.39e-05 s or less, or leave it out: it is then rayleigh_fraction of that time");
  EXPECT_TRUE(problems_of(std::string(kGood) + "numerics: {time_step: 0.179 ms}\n").empty());
}

TEST(Case, ATimeStepBesideABrokenGrainIsNotJudged) {
  std::string text = std::string(kGood) + "numerics: {time_step: 1 s}\n";
  text.replace(text.find("2650 kg/m3"), 10, "2650 kg   ");
  EXPECT_EQ(problems_of(text).size(), 1u);
}

TEST(Case, ATimeStepOverASoundShareOfTheRayleighTimeIsAWarning) {
  const auto warnings_of = [](const std::string& numerics) {
    // Slow enough that the shortest collision leaves an automatic step alone.
    std::string slow = kGood + numerics;
    slow.replace(slow.find("1.67 m/s"), 8, "1.67mm/s");
    const YamlNode node = parse_yaml(slow, "case.yaml");
    std::vector<Problem> problems;
    const Case input = read_case(node, problems);
    EXPECT_TRUE(problems.empty());
    std::string text;
    for (const Problem& one : case_warnings(node, input)) text += one.text();
    return text;
  };
  EXPECT_EQ(warnings_of(""), "");
  EXPECT_EQ(warnings_of("numerics: {time_step: 0.053 ms}\n"), "");
  EXPECT_EQ(
      warnings_of("numerics: {time_step: 0.06 ms}\n"),
      "case.yaml:18:23: numerics.time_step: makes the time step 0.334 of the Rayleigh time of "
      "the smallest grain, 0.00018 s; over 0.3 of it contacts may gain energy");
  EXPECT_EQ(warnings_of("numerics: {rayleigh_fraction: 0.4}\n")
                .find("case.yaml:18:31: numerics.rayleigh_fraction: makes the time step 0.4 of"),
            0u);
}

TEST(Case, WrittenCaseReadsBackToTheSameBits) {
  std::vector<Problem> problems;
  const Case first = read_case(parse_yaml(kGood, "a"), problems);
  const Case second = read_case(parse_yaml(emit_yaml(write_case(first)), "b"), problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(content_key(first), content_key(second));
  EXPECT_EQ(first.wheel.diameter, second.wheel.diameter);
}

TEST(Case, KeyFollowsPhysicsAndNotOutput) {
  std::vector<Problem> problems;
  const Case first = read_case(parse_yaml(kGood, "a"), problems);
  Case other = first;
  other.output.series_interval = 1.0;
  EXPECT_EQ(content_key(first), content_key(other));
  other.wheel.slip = 0.2;
  EXPECT_NE(content_key(first), content_key(other));
  EXPECT_EQ(content_key(bed_case(first)), content_key(bed_case(other)));
}

TEST(Case, KeyLeavesOutWhatDriveAndProfileNeverLookAt) {
  std::vector<Problem> problems;
  Case towed = read_case(parse_yaml(kGood, "a"), problems);
  towed.wheel.drive = "towed";
  towed.wheel.profile = "drum";
  Case other = towed;
  other.wheel.slip = 0.2;
  other.wheel.torque = 1.0;
  other.wheel.grousers = 7;
  other.wheel.stl_file = "w.stl";
  EXPECT_EQ(content_key(towed), content_key(other));
  other.wheel.facets = towed.wheel.facets + 1;
  EXPECT_NE(content_key(towed), content_key(other));

  Case surface = towed;
  surface.wheel.profile = "stl";
  surface.wheel.stl_file = "../../surfaces/abc.stl";
  other = surface;
  other.wheel.stl_file = "/elsewhere/abc.stl";
  EXPECT_EQ(content_key(surface), content_key(other));
  other.wheel.stl_file = "/elsewhere/def.stl";
  EXPECT_NE(content_key(surface), content_key(other));
}

TEST(Case, DurationIsSettlingPlusTravelWithItsRamp) {
  std::vector<Problem> problems;
  Case input = read_case(parse_yaml(kGood, "a"), problems);
  input.wheel.settle_time = 0.1;
  input.wheel.forward_speed = 2.0;
  input.wheel.ramp_time = 0.02;
  input.wheel.travel = 0.4;
  EXPECT_DOUBLE_EQ(run_duration(input), 0.1 + 0.01 + 0.2);
  input.wheel.travel = 0.005;  // shorter than the ramp's 0.02 m: s = v t^2 / (2 T)
  EXPECT_DOUBLE_EQ(run_duration(input), 0.1 + 0.01);
  EXPECT_EQ(run_duration(bed_case(input)), 0.0);
}

TEST(Case, TenMistakesAreReportedInOnePass) {
  const std::vector<Problem> problems = problems_of(R"(
gravity: 9.81
box: {length: 1.2 m, width: -53 cm}
grains:
  densty: 2650 kg/m3
  size_curve: [{diameter: 0.76 s, finer: 0}, {diameter: 2.29 mm, finer: 1.5}]
contact:
  rolling: elastic_plastik
  grain_grain: {restitution: 0, friction: 0.5}
  grain_box: 3
bed: {depth: twenty cm}
)");
  std::string all;
  for (const Problem& problem : problems) all += problem.text() + "\n";
  for (const char* part :
       {"case.yaml:2:10: gravity: '9.81' has no unit", "box.width: '-53 cm' is out of range",
        "box.depth: is missing", "grains.density: is missing",
        "grains.densty: unknown key; did you mean 'density'?",
        "size_curve[0].diameter: unit 's' cannot be turned into 'm'",
        "size_curve[1].finer: '1.5' is out of range",
        "contact.rolling: 'elastic_plastik' is not one of its words; did you mean "
        "'elastic_plastic'?",
        "contact.grain_grain.restitution: '0' is out of range", "contact.grain_box: must be a map",
        "bed.depth: 'twenty cm' is not a number"})
    EXPECT_NE(all.find(part), std::string::npos) << part << " is missing from\n" << all;
}

TEST(Case, RulesBetweenValuesAreChecked) {
  std::string text = kGood;
  text.replace(text.find("travel: 40 cm"), 13, "travel: 4 m  ");
  const std::vector<Problem> problems = problems_of(text);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].text(),
            "case.yaml:12:3: wheel: runs into the end wall; start, travel and a quarter of the "
            "diameter must fit into the box length");
}

TEST(Case, AWheelInTheBackWallAndABedThinnerThanAGrainAreRefused) {
  std::string text = kGood;
  text += "  start: 0.1\n";
  ASSERT_EQ(problems_of(text).size(), 1u);
  EXPECT_NE(problems_of(text)[0].text().find("starts in the back wall"), std::string::npos);
  text = kGood;
  text.replace(text.find("depth: 20 cm"), 12, "depth: 20 mm");
  ASSERT_EQ(problems_of(text).size(), 1u);
  EXPECT_NE(problems_of(text)[0].text().find("less than one grain"), std::string::npos);
}

}  // namespace
}  // namespace grouser
