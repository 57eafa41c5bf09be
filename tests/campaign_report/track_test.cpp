// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <fstream>

#include "campaign/report/figures.hpp"
#include "campaign/report/page.hpp"
#include "campaign/report/run_output.hpp"
#include "markup.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

// A run of placed grains whose tracked one sinks at 10 mm/s from a gap of 50 mm.
RunData sinking() {
  RunData run;
  run.label = "E1-drag";
  run.is_bed = run.is_finished = true;
  run.axes = {{"liquid", "E1"}, {"model", "drag"}};
  run.track = parse_track(
      "step [1],time [s],gap [m],velocity_z [m s-1]\n0,0,0.05,-0.01\n10,1,0.04,-0.01\n20,2,0.0",
      "track.csv");
  return run;
}

ReportData beside(RecordedCurve curve) {
  ReportData data;
  data.name = "settling";
  data.runs = {sinking()};
  data.recorded_series = {{"tencate", "A sphere", "ten Cate", "none", {std::move(curve)}}};
  return data;
}

TEST(Track, LeavesOutARowThatIsBeingWritten) { EXPECT_EQ(sinking().track.time.size(), 2u); }

TEST(Track, StandsBesideTheConditionOfItsSweepPoint) {
  const ReportData data = beside({"E1", "gap", false, 1e-3, {0.5, 5.0}, {0.046, 0.0}});
  const auto curves = curves_of(data, data.runs[0], TrackSignal::kGap);
  ASSERT_EQ(curves.size(), 1u);
  // 45 mm against 46 mm; the run does not reach the other time.
  EXPECT_NEAR(rms_difference(data.runs[0].track, TrackSignal::kGap, *curves[0]), 1.0, 1e-9);
  EXPECT_TRUE(curves_of(data, data.runs[0], TrackSignal::kVelocity).empty());
  const std::string page = report_html(data, analyse(data));
  EXPECT_EQ(markup::first_fault(page), "");
  EXPECT_NE(page.find("<section id=\"tracks\""), std::string::npos);
  EXPECT_EQ(markup::count_of(page, "data-series=\"recorded\""), 2);
  const ReportData other = beside({"E2", "gap", false, 0.0, {0.5}, {0.046}});
  EXPECT_TRUE(curves_of(other, other.runs[0], TrackSignal::kGap).empty());
}

TEST(Track, CountsDownwardSpeedPositive) {
  for (const auto& [channel, value] :
       {std::pair{"settling_speed", 0.012}, {"vertical_velocity", -0.012}}) {
    const ReportData data = beside({"E1", channel, false, 0.0, {0.5}, {value}});
    const auto curves = curves_of(data, data.runs[0], TrackSignal::kVelocity);
    ASSERT_EQ(curves.size(), 1u);
    EXPECT_NEAR(rms_difference(data.runs[0].track, TrackSignal::kVelocity, *curves[0]), 2.0, 1e-9);
  }
}

TEST(Track, RecordingsOfTheRepositoryAreRead) {
  for (const char* name : {"tencate2002_settling", "gondret2002_bounce"}) {
    const auto folder = std::filesystem::path(GROUSER_SOURCE_DIR) / "configs/recordings" / name;
    ASSERT_TRUE(has_recorded_series(folder));
    std::vector<Problem> problems;
    const RecordedSeries series = read_recorded_series(folder, problems);
    for (const Problem& problem : problems) ADD_FAILURE() << problem.text();
    ASSERT_FALSE(series.curves.empty());
    for (const RecordedCurve& curve : series.curves) {
      EXPECT_GT(curve.time.size(), 20u);
      EXPECT_LT(curve.value.front(), 0.2);  // metres, whatever the CSV has
    }
  }
}

TEST(Track, ARecordingThatCannotBeReadIsNamed) {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "recording.yaml") << R"(
recording: 2
name: x
title: x
source: {citation: x, licence: x, provenance: x}
time: {column: t, unit: s}
channels: [{name: gap, unit: s, column: gap}]
conditions: [{name: a, data: a.csv}]
)";
  std::vector<Problem> problems;
  read_recorded_series(folder.path(), problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].line, 7);
}

}  // namespace
}  // namespace grouser
