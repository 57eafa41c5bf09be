// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/recordings/admission.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace grouser::diagnosis {
namespace {

/// A sphere that comes to its terminal speed: gap and downward speed, with noise.
SeriesRecording settling(unsigned seed, double gain, double lag) {
  SeriesRecording recording;
  recording.channels = {
      {"gap", "m", "gap", "", "estimate", Signal::kGap, 0.0, 1.0},
      {"settling_speed", "m s-1", "speed", "", "estimate", Signal::kSettlingSpeed, 0.0, 1.0}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Condition condition{"a", "a.csv", "fit", {}, {}, {{}, {}}, {}};
  const double relaxation = 0.05;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.002 * i;
    const double delayed = std::max(0.0, t - lag);
    condition.times.push_back(t);
    condition.lines.push_back(i + 2);
    condition.samples[0].push_back(
        0.1 - 0.1 * (t - relaxation * (1.0 - std::exp(-t / relaxation))) + 2e-5 * normal(random));
    condition.samples[1].push_back((1.0 + gain) * 0.1 * (1.0 - std::exp(-delayed / relaxation)) +
                                   2e-4 * normal(random));
  }
  recording.conditions.push_back(condition);
  return recording;
}

bool has(const std::vector<Finding>& findings, const std::string& kind) {
  return std::any_of(findings.begin(), findings.end(),
                     [&](const Finding& finding) { return finding.kind == kind; });
}

TEST(Admission, SoundChannelsRaiseNoFault) {
  for (unsigned seed = 1; seed <= 50; ++seed)
    for (const Finding& finding : admit(settling(seed, 0.0, 0.0)))
      ADD_FAILURE() << "seed " << seed << ": " << finding.text;
}

TEST(Admission, AWrongScaleOfTheSpeedIsNamed) {
  EXPECT_TRUE(has(admit(settling(1, 0.03, 0.0)), "gain"));
}

TEST(Admission, ALateSpeedIsNamedWithItsDelay) {
  const SeriesRecording recording = settling(1, 0.0, 0.008);
  EXPECT_TRUE(has(admit(recording), "lag"));
  const Condition& c = recording.conditions[0];
  const Consistency found = compare_gap_and_speed(c.times, c.samples[0], c.samples[1], 2e-5);
  // The expansion in the lag is of first order: 8 ms against a relaxation of 50 ms.
  EXPECT_NEAR(found.lag, 0.008, 0.002);
}

TEST(Admission, AClippedSensorIsNamedAtItsFirstLine) {
  SeriesRecording recording = settling(1, 0.0, 0.0);
  for (double& value : recording.conditions[0].samples[1]) value = std::min(value, 0.09);
  const std::vector<Finding> findings = admit(recording);
  ASSERT_TRUE(has(findings, "clipping"));
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [](const Finding& f) { return f.kind == "clipping"; });
  EXPECT_NEAR(found->line, 0.05 * std::log(10.0) / 0.002 + 2, 5.0);
}

TEST(Admission, MissingRowsAreCounted) {
  SeriesRecording recording = settling(1, 0.0, 0.0);
  Condition& c = recording.conditions[0];
  const auto cut = [](auto& values) { values.erase(values.begin() + 100, values.begin() + 103); };
  cut(c.times);
  cut(c.lines);
  for (auto& samples : c.samples) cut(samples);
  const std::vector<Finding> findings = admit(recording);
  ASSERT_TRUE(has(findings, "missing_rows"));
  EXPECT_EQ(findings[0].text.substr(0, 6), "3 rows");
  EXPECT_EQ(findings[0].line, 105);
}

}  // namespace
}  // namespace grouser::diagnosis
