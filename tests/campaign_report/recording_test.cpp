// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "campaign/plan/expand.hpp"
#include "campaign/report/report.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

const fs::path kConfigs = fs::path(GROUSER_SOURCE_DIR) / "configs";

std::string text_of(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& problem : problems) text += problem.text() + "\n";
  return text;
}

const RecordingPoint* find(const Recording& recording, const std::string& condition,
                           const std::string& kind, Observable observable) {
  for (const RecordingPoint& point : recording.points)
    if (point.condition == condition && point.kind == kind && point.observable == observable)
      return &point;
  return nullptr;
}

/// A recording folder of its own in the test's temporary directory.
class RecordingFolder {
 public:
  explicit RecordingFolder(const std::string& name)
      : path_(fs::path(testing::TempDir()) / ("recording_" + name)) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(path_ / file) << text;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const char* const kYaml = R"(recording: 1
name: test
title: Test
source: {citation: c, licence: l, provenance: p}
apparatus: {wheel_diameter: 10 cm, wheel_width: 5 cm, load: 20 N, forward_speed: 1 cm/s, soil: sand}
slip_definition: bounded
channels:
  - {name: sinkage, unit: mm, sign: downward}
points: points.csv
)";

TEST(Recordings, AllCommittedOnesAreSound) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kConfigs / "recordings")) {
    // Series are read by the diagnosis and tested there.
    if (load_yaml(entry.path() / "recording.yaml").find("recording")->scalar != "1") continue;
    std::vector<Problem> problems;
    const Recording recording = read_recording(entry.path(), problems);
    EXPECT_EQ(text_of(problems), "");
    EXPECT_EQ(recording.name, entry.path().filename().string());
    EXPECT_FALSE(recording.points.empty());
    ++count;
  }
  EXPECT_GE(count, 2);
}

TEST(Recordings, PaperHasTheNumbersOfItsTableTwo) {
  std::vector<Problem> problems;
  const Recording r = read_recording(kConfigs / "recordings/jelinek2020_wheel_71cm", problems);
  const auto value = [&](const char* condition, const char* kind, Observable observable) {
    return find(r, condition, kind, observable)->value;
  };
  EXPECT_EQ(value("slip_20", "lab", Observable::kPullCoefficient), 0.17);
  EXPECT_EQ(value("slip_20", "paper_dem", Observable::kPullCoefficient), 0.15);
  EXPECT_EQ(value("slip_20", "lab", Observable::kGrossCoefficient), 0.31);
  EXPECT_EQ(value("slip_20", "paper_dem", Observable::kGrossCoefficient), 0.20);
  EXPECT_EQ(value("towed", "lab", Observable::kPullCoefficient), -0.12);
  EXPECT_EQ(value("towed", "paper_dem", Observable::kPullCoefficient), -0.08);
  EXPECT_TRUE(std::isnan(r.points[0].uncertainty)) << "unknown is not zero";
}

// Means of the three locked-wheel trials, worked out by hand from the source's table.
TEST(Recordings, TestbedHoldsTheMeansOfItsTrials) {
  std::vector<Problem> problems;
  const Recording r = read_recording(kConfigs / "recordings/cmu_smooth_wheel", problems);
  EXPECT_EQ(r.points.size(), 9u * 4u);
  const RecordingPoint* locked = find(r, "rim_0_mm_s", "lab", Observable::kPull);
  EXPECT_NEAR(locked->value, (-38.1885 - 39.1214 - 39.2241) / 3.0, 1e-3);
  EXPECT_NEAR(locked->uncertainty, 0.571, 1e-3);
  EXPECT_EQ(locked->slip, -1.0);
  EXPECT_EQ(r.definition(), SlipDefinition::kBounded);
  const double sinkage = find(r, "rim_0_mm_s", "lab", Observable::kSinkage)->value;
  EXPECT_NEAR(sinkage, (50.1221 + 51.0452 + 49.7745) / 3e3, 1e-6) << "in metres";
}

TEST(Recordings, EveryMistakeIsReportedWithItsPlace) {
  const RecordingFolder folder("mistakes");
  folder.write("recording.yaml", kYaml);
  folder.write("points.csv",
               "condition,slip,kind,observable,value,uncertainty,trials\n"
               "a,0.1,lab,sinkage,12,0.5,3\n"
               ",x,guess,pull,,y,\n"
               "short,row\n"
               "towed,,lab,sinkage,10,,\n");
  std::vector<Problem> problems;
  const Recording r = read_recording(folder.path(), problems);
  const std::string text = text_of(problems);
  for (const char* const part :
       {"points.csv:3: condition: is empty", "kind: 'guess' is neither",
        "slip: 'x' is not a number", "observable: 'pull' is not one of the channels",
        "value: is empty", "uncertainty: 'y' is not a number",
        "points.csv:4: row: has 2 cells instead of 7"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing from\n" << text;
  EXPECT_EQ(problems.size(), 7u) << text;
  EXPECT_NEAR(r.points[0].value, 0.012, 1e-15);
  EXPECT_NEAR(r.points[0].uncertainty, 0.0005, 1e-15);
}

TEST(Recordings, UnitsThatDoNotFitAreRefused) {
  const RecordingFolder folder("units");
  std::string yaml = kYaml;
  yaml.replace(yaml.find("unit: mm"), 8, "unit: kg");
  folder.write("recording.yaml", yaml);
  std::vector<Problem> problems;
  read_recording(folder.path(), problems);
  EXPECT_NE(text_of(problems).find("'kg' cannot be turned into the observable's unit"),
            std::string::npos)
      << text_of(problems);
}

TEST(Recordings, MissingFilesAreProblemsAndNotTheEnd) {
  const RecordingFolder folder("missing");
  std::vector<Problem> problems;
  read_recording(folder.path(), problems);
  EXPECT_EQ(problems.size(), 1u);
  folder.write("recording.yaml", kYaml);
  read_recording(folder.path(), problems);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_NE(problems[1].text().find("no such file"), std::string::npos);
}

TEST(ReportSettings, UnknownWordsAndKeysAreRefused) {
  std::vector<Problem> problems;
  check_report(
      parse_yaml("horizontal: slipp\nrecordings: [{path: nowhere}]\nneglectd: []\n", "c.yaml"),
      kConfigs, problems);
  const std::string text = text_of(problems);
  for (const char* const part :
       {"c.yaml:1:13: report.horizontal: 'slipp'", "did you mean 'neglected'",
        "c.yaml:2:21: report.recordings[0].path: ", "nowhere/recording.yaml: cannot be read"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing from\n" << text;
}

TEST(CommittedCampaigns, ExpandAndNameSoundRecordings) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kConfigs / "campaigns")) {
    SCOPED_TRACE(entry.path().string());
    std::vector<Problem> problems;
    const CampaignFile file = read_campaign(entry.path(), "", problems);
    check_report(file.report, entry.path().parent_path(), problems);
    const Plan plan = make_plan(file, problems);
    EXPECT_EQ(text_of(problems), "");
    EXPECT_FALSE(plan.runs.empty());
    ++count;
  }
  EXPECT_GE(count, 3);
}

// The publication's count of grains in its volume, at the solid fraction the full deck states.
TEST(CommittedCampaigns, FullDeckHoldsThePublicationsGrains) {
  std::vector<Problem> problems;
  const CampaignFile file =
      read_campaign(kConfigs / "campaigns/wheel_71cm_full.yaml", "", problems);
  const Plan plan = make_plan(file, problems);
  ASSERT_FALSE(plan.runs.empty()) << text_of(problems);
  const Case& input = plan.runs.back().input;
  double mean_cube = 0.0;
  const std::vector<SizePoint>& curve = input.grains.size_curve;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double a = curve[i - 1].diameter;
    const double b = curve[i].diameter;
    mean_cube += (curve[i].finer - curve[i - 1].finer) * (a + b) * (a * a + b * b) / 4.0;
  }
  const double volume = input.box.length * input.box.width * input.bed.depth;
  const double grains = input.bed.solid_fraction * volume / (std::acos(-1.0) / 6.0 * mean_cube);
  EXPECT_NEAR(grains / 36037017.0, 1.0, 0.01);
}

// Its head lists these; any other difference would be a value without a reason.
TEST(CommittedCampaigns, FullDeckDiffersFromTheSlipSweepWhereItsHeadSays) {
  std::vector<Problem> problems;
  const auto runs_of = [&](const char* name) {
    return make_plan(read_campaign(kConfigs / "campaigns" / name, "", problems), problems).runs;
  };
  const auto full = runs_of("wheel_71cm_full.yaml");
  const auto sweep = runs_of("wheel_71cm_slip_sweep.yaml");
  ASSERT_EQ(text_of(problems), "");
  ASSERT_EQ(full.size(), sweep.size());
  for (std::size_t i = 0; i < full.size(); ++i) {
    Case input = full[i].input;
    EXPECT_EQ(input.grains.coarse_graining, 1.0);
    for (SolidCase* solid : {&input.grains.solid, &input.box.solid, &input.wheel.solid}) {
      if (solid == &input.wheel.solid && !input.has_wheel) continue;
      EXPECT_EQ(solid->young_modulus, 500e6);
      solid->young_modulus = 100e6;
    }
    input.grains.coarse_graining = 16.0;
    input.bed.solid_fraction = 0.62;
    if (input.has_wheel) input.wheel.facets = 180;
    input.output.checkpoint_interval = 0.05;
    EXPECT_EQ(emit_yaml(write_case(input)), emit_yaml(write_case(sweep[i].input))) << full[i].label;
  }
}

}  // namespace
}  // namespace grouser
