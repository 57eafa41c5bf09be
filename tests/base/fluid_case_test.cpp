// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "base/case.hpp"
#include "tests/base/case_problems.hpp"

namespace grouser {
namespace {

const char* const kSphere = R"(
box: {length: 10 cm, width: 10 cm, depth: 16 cm}
placed:
  duration: 4 s
  grains:
    - {diameter: 15 mm, x: 5 cm, y: 5 cm, z: 127.5 mm}
    - {diameter: 5 mm, x: 5 cm, y: 5 cm, z: 10 mm, velocity_z: 1 m/s}
grains: {density: 1120 kg/m3}
contact:
  grain_grain: {restitution: 0.9, friction: 0.3}
  grain_box: {restitution: 0.9, friction: 0.3}
fluid:
  density: 970 kg/m3
  viscosity: 373 mPa s
  drag: {law: abraham}
  history: {amplitude: 0.5}
probes:
  - {grain: 1, along: gap, from: 0 mm, peak: 1 mm, to: 2 mm, force: 1 mN}
output: {track: {grain: 1}}
)";

std::string changed(const std::string& from, const std::string& to) {
  return problems_of(grouser::changed(kSphere, from, to));
}

TEST(FluidCase, PlacedGrainsInAFluidReadBackToTheSameBits) {
  std::vector<Problem> problems;
  const Case first = read_case(parse_yaml(kSphere, "a"), problems);
  const Case second = read_case(parse_yaml(emit_yaml(write_case(first)), "b"), problems);
  EXPECT_EQ(problems_of(kSphere), "");
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(content_key(first), content_key(second));
  EXPECT_EQ(run_duration(first), 4.0);
  EXPECT_EQ(second.fluid.viscosity, 0.373);
  EXPECT_EQ(second.fluid.drag.law, "abraham");
  EXPECT_EQ(second.fluid.drag.amplitude, 1.0);
  EXPECT_EQ(second.fluid.history.amplitude, 0.5);
  EXPECT_EQ(second.probes.at(0).at(1.5e-3), 0.5e-3);
  EXPECT_EQ(second.placed.grains.at(1).velocity_z, 1.0);
  EXPECT_EQ(second.grains.size_curve.front().diameter, 5e-3);
}

TEST(FluidCase, KeyFollowsForcesAndNotTheTrack) {
  std::vector<Problem> problems;
  const Case first = read_case(parse_yaml(kSphere, "a"), problems);
  Case other = first;
  other.output.has_track = false;
  EXPECT_EQ(content_key(first), content_key(other));
  other.fluid.history.amplitude = 1.0;
  EXPECT_NE(content_key(first), content_key(other));
  other = first;
  other.probes[0].force = 2e-3;
  EXPECT_NE(content_key(first), content_key(other));
}

TEST(FluidCase, AProbeIsAHat) {
  ProbeCase probe{0, "z", "time", 1.0, 2.0, 4.0, 10.0};
  EXPECT_EQ(probe.at(0.9), 0.0);
  EXPECT_EQ(probe.at(1.5), 5.0);
  EXPECT_EQ(probe.at(2.0), 10.0);
  EXPECT_EQ(probe.at(3.0), 5.0);
  EXPECT_EQ(probe.at(4.1), 0.0);
  probe.from = 2.0;  // a half hat begins at its height
  EXPECT_EQ(probe.at(2.0), 10.0);
}

TEST(FluidCase, BadInputSaysWhatIsWrong) {
  const auto has = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nin: " << text;
  };
  has(changed("z: 127.5 mm", "z: 1 mm"), "grain 0 is not inside the box");
  has(changed("z: 10 mm", "z: 125 mm"), "has grains that overlap");
  has(changed("grain: 1, along", "grain: 2, along"), "name a grain that is not there");
  has(changed("{grain: 1}}", "{grain: 5}}"), "names a grain that is not there");
  has(changed("peak: 1 mm", "peak: 3 mm"), "is not between from and to");
  has(changed("to: 2 mm", "to: 2 s"), "probes[0].to");
  has(changed("law: abraham", "law: abrahm"), "did you mean 'abraham'");
  has(changed("viscosity: 373 mPa s", "viscosity: 0 Pa s"), "fluid.viscosity");
  has(changed("viscosity: 373 mPa s", "viscosity: 373 m"), "fluid.viscosity");
  has(changed("373 mPa s", "373 kPa s"), "too fast for the time step");
  has(changed("history:", "wall: {law: faxen}\n  history:"), "is needed for law faxen");
  has(changed("history:", "wall: {law: faxen, diameter: 20 mm}\n  history:"), "is too near");
  has(changed("history:", "lubrication: {cutoff_gap: 1e-4}\n  history:"),
      "is not above the smallest gap");
  has(changed("density: 970 kg/m3", "density: 970 kg/m3\n  void_fraction: 0"), "void_fraction");
}

TEST(FluidCase, ACaseWithoutOneIsWrittenAsBefore) {
  // Keys of runs made before there were fluids must not change.
  const std::string text = emit_yaml(write_case(Case{}));
  for (const char* key : {"fluid", "placed", "probes", "track"})
    EXPECT_EQ(text.find(key), std::string::npos) << key;
}

}  // namespace
}  // namespace grouser
