// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "base/case.hpp"
#include "base/lattice_units.hpp"
#include "base/time_step.hpp"
#include "tests/base/case_problems.hpp"

namespace grouser {
namespace {

const char* const kSphere = R"(
box: {length: 10 cm, width: 10 cm, depth: 16 cm}
placed:
  duration: 4 s
  grains:
    - {diameter: 15 mm, x: 5 cm, y: 5 cm, z: 127.5 mm}
grains: {density: 1120 kg/m3}
contact:
  grain_grain: {restitution: 0.9, friction: 0.3}
  grain_box: {restitution: 0.9, friction: 0.3}
fluid:
  mode: resolved
  density: 970 kg/m3
  viscosity: 373 mPa s
  lattice:
    cell: 1 mm
    speed: 4 cm/s
    mach: 0.02
)";

std::string changed(const std::string& from, const std::string& to) {
  return grouser::changed(kSphere, from, to);
}

Case case_of(const std::string& text) {
  std::vector<Problem> problems;
  const Case input = read_case(parse_yaml(text, "case.yaml"), problems);
  EXPECT_TRUE(problems.empty()) << problems.front().text();
  return input;
}

void expect_problem(const std::string& from, const std::string& to, const std::string& position,
                    const std::string& what) {
  const std::string found = problems_of(changed(from, to));
  EXPECT_NE(found.find(what), std::string::npos) << to << ": " << found;
  EXPECT_NE(found.find("case.yaml:" + position), std::string::npos) << found;
}

TEST(LatticeCase, StepAndNumbersFollowFromSpeedAndMach) {
  const Case input = case_of(kSphere);
  const LatticeScale s = lattice_scale(input, longest_time_step(input));
  EXPECT_EQ(s.cells, (std::array<std::int64_t, 3>{100, 100, 160}));
  // Sound crosses a cell in 1/sqrt(1/3) steps: Mach = sqrt(3) speed step / cell.
  const double step = 0.02 / std::sqrt(3.0) * 1e-3 / 0.04;
  EXPECT_DOUBLE_EQ(s.units.step, step);
  EXPECT_NEAR(s.relaxation_time, 0.5 + 3.0 * 0.373 / 970.0 * step / 1e-6, 1e-12);
  EXPECT_NEAR(s.mach, 0.02, 1e-15);
  EXPECT_NEAR(s.grid_reynolds, 0.04 * 1e-3 * 970.0 / 0.373, 1e-12);
  EXPECT_NEAR(s.smallest_grain, 15.0, 1e-12);
}

TEST(LatticeCase, GrainsMakeAWholeNumberOfStepsInOneOfTheLattice) {
  const Case input = case_of(kSphere);
  const double grains = time_step_of(input);
  const LatticeScale s = lattice_scale(input, grains);
  EXPECT_GT(s.substeps, 1);
  EXPECT_DOUBLE_EQ(grains * static_cast<double>(s.substeps), s.units.step);
  EXPECT_LE(grains, longest_time_step(input));
  EXPECT_GT(grains * static_cast<double>(s.substeps + 1) / static_cast<double>(s.substeps),
            longest_time_step(input) * (1.0 - 1e-12));
}

TEST(LatticeCase, UnitsTurnIntoEachOtherAsDimensionsSay) {
  LatticeUnits units;
  units.cell = 2e-3;
  units.step = 5e-4;
  units.density = 1200.0;
  EXPECT_DOUBLE_EQ(units.velocity(units.velocity_lu(0.3)), 0.3);
  EXPECT_DOUBLE_EQ(units.velocity_lu(0.3), 0.3 * 5e-4 / 2e-3);
  // The mass of a cell that changes its speed by one cell per step within a step.
  EXPECT_DOUBLE_EQ(units.force(1.0), 1200.0 * 8e-9 * (2e-3 / 5e-4) / 5e-4);
  EXPECT_DOUBLE_EQ(units.moment(1.0), units.force(1.0) * 2e-3);
  EXPECT_NEAR(units.pressure(units.density_lu(50.0)), 50.0, 1e-9);
  // Sound: a third of the squared cell per step.
  EXPECT_NEAR(units.pressure(1.03), 0.01 * 1200.0 * 16.0, 1e-9);
}

TEST(LatticeCase, ReadsBackToTheSameBits) {
  const Case first =
      case_of(changed("mach: 0.02", "mach: 0.02\n    faces: {z_high: {kind: slip}}"));
  const Case second = case_of(emit_yaml(write_case(first)));
  EXPECT_EQ(content_key(first), content_key(second));
  EXPECT_EQ(second.fluid.lattice.faces[5].kind, "slip");
  EXPECT_NE(content_key(first), content_key(case_of(kSphere)));
}

TEST(LatticeCase, BadInputIsNamedWhereItStands) {
  expect_problem("mach: 0.02", "relaxation_time: 0.5", "18:22", "is not over 0.5");
  expect_problem("mach: 0.02", "relaxation_time: 0.4999", "18:22", "is not over 0.5");
  expect_problem("mach: 0.02", "mach: 0.4", "18:11", "0.3");
  expect_problem("4 cm/s\n    mach: 0.02", "20 cm/s\n    relaxation_time: 2", "16:5",
                 "Mach number of");
  expect_problem("cell: 1 mm", "cell: 3 mm", "16:11", "does not divide box.length");
  expect_problem("cell: 1 mm", "cell: 5 mm", "16:11", "too few to be resolved");
  expect_problem("cell: 1 mm", "cell: 1 um", "16:11", "no machine holds them");
  expect_problem("    speed: 4 cm/s\n", "", "16:5", "speed");
  expect_problem("viscosity: 373 mPa s", "viscosity: 1e-4 mPa s", "16:5", "relaxation time of");
  expect_problem("mode: resolved", "mode: submerged", "16:5", "goes with mode resolved alone");
  expect_problem("mach: 0.02", "mach: 0.02\n    faces: {x_low: {kind: periodic}}",
                 "19:", "not both periodic");
  expect_problem("density: 1120", "density: 500", "7:19", "so light grains");
  const std::string text = kSphere;
  EXPECT_NE(problems_of(text.substr(0, text.find("  lattice:"))).find("resolved needs a lattice"),
            std::string::npos);
}

TEST(LatticeCase, ACoarseLatticeIsWarnedOf) {
  const std::string text = changed("cell: 1 mm", "cell: 2.5 mm");
  const YamlNode node = parse_yaml(text, "case.yaml");
  std::vector<Problem> problems;
  const Case input = read_case(node, problems);
  ASSERT_TRUE(problems.empty()) << problems.front().text();
  std::string all;
  for (const Problem& one : case_warnings(node, input)) all += one.text() + "\n";
  EXPECT_NE(all.find("leaves the smallest grain 6 cells"), std::string::npos) << all;
}

TEST(LatticeCase, TextSaysHowFarResultsMayBeOff) {
  const std::string text = lattice_text(case_of(kSphere));
  EXPECT_NE(text.find("lattice of 100 x 100 x 160 cells of 0.001 m"), std::string::npos) << text;
  EXPECT_NE(text.find("Mach number 0.02"), std::string::npos) << text;
  EXPECT_NE(text.find("off by some 0.04 % for compressibility"), std::string::npos) << text;
  EXPECT_NE(text.find("15 cells wide"), std::string::npos) << text;
}

TEST(LatticeCase, TheBedUnderAWheelSettlesWithoutALattice) {
  Case input = case_of(kSphere);
  input.has_wheel = true;
  const Case bed = bed_case(input);
  EXPECT_EQ(bed.fluid.mode, "submerged");
  EXPECT_FALSE(bed.fluid.has_lattice);
  input.has_wheel = false;
  EXPECT_EQ(bed_case(input).fluid.mode, "resolved");
}

}  // namespace
}  // namespace grouser
