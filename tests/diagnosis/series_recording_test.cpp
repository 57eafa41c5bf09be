// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "diagnosis/recordings/recording.hpp"

namespace grouser::diagnosis {
namespace {

namespace fs = std::filesystem;

const char* const kYaml = R"(recording: 2
name: test
title: Test
source: {citation: c, licence: l, provenance: p}
experiment:
  case: sphere_in_fluid
  values:
    - {name: diameter, value: 15 mm, uncertainty: 1 %DIAMETER%}
    - {name: particle_density, value: 1120 kg m-3}
    - {name: fluid_density, value: 970 kg m-3}
time: {column: t, unit: ms}
channels:
  - {name: gap, unit: mm, column: h, sign: upward}
conditions:
  - name: a
    data: a.csv
    values: [{name: viscosity, value: "0.1 Pa s", uncertainty: "0.01 Pa s"}]
)";

std::string yaml_with(const std::string& unit) {
  std::string text = kYaml;
  const std::string mark = "%DIAMETER%";
  return text.replace(text.find(mark), mark.size(), unit);
}

/// A folder with a recording and one series of ten rows, of which row 5 is `fifth`.
fs::path folder_with(const std::string& yaml, const std::string& header, const std::string& fifth) {
  const fs::path folder =
      fs::path(testing::TempDir()) /
      ("series_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ofstream(folder / "recording.yaml") << yaml;
  std::ofstream csv(folder / "a.csv");
  csv << header << "\n";
  for (int i = 0; i < 10; ++i)
    csv << (i == 5 ? fifth : std::to_string(10 * i) + "," + std::to_string(100 - i)) << "\n";
  return folder;
}

std::string problems_of(const fs::path& folder) {
  std::vector<Problem> problems;
  read_series_recording(folder, problems);
  std::string text;
  for (const Problem& problem : problems)
    text += fs::path(problem.file).filename().string() + ":" + std::to_string(problem.line) + ":" +
            std::to_string(problem.column) + " " + problem.key + "\n";
  return text;
}

TEST(SeriesRecording, NumbersComeOutInSi) {
  const fs::path folder = folder_with(yaml_with("mm"), "t,h", "50,95");
  std::vector<Problem> problems;
  const SeriesRecording recording = read_series_recording(folder, problems);
  ASSERT_TRUE(problems.empty()) << problems[0].text();
  EXPECT_DOUBLE_EQ(recording.values[0].value, 0.015);
  EXPECT_DOUBLE_EQ(recording.values[0].uncertainty, 0.001);
  EXPECT_DOUBLE_EQ(recording.conditions[0].times[5], 0.05);
  EXPECT_DOUBLE_EQ(recording.conditions[0].samples[0][5], 0.095);
}

TEST(SeriesRecording, AWrongUnitIsNamedWhereItStands) {
  EXPECT_EQ(problems_of(folder_with(yaml_with("kg"), "t,h", "50,95")),
            "recording.yaml:8:51 experiment.values[0].uncertainty\n");
}

TEST(SeriesRecording, AUnitInTheHeaderMustBeTheOneDeclared) {
  EXPECT_EQ(problems_of(folder_with(yaml_with("mm"), "t [ms],h [m]", "50,95")), "a.csv:1:8 h\n");
}

TEST(SeriesRecording, ACellThatIsNoNumberIsNamedByLineAndColumn) {
  EXPECT_EQ(problems_of(folder_with(yaml_with("mm"), "t,h", "50,o95")), "a.csv:7:4 h\n");
}

TEST(SeriesRecording, TimesThatDoNotRiseAreNamed) {
  EXPECT_EQ(problems_of(folder_with(yaml_with("mm"), "t,h", "40,95")), "a.csv:7:1 t\n");
}

TEST(SeriesRecording, ASampleThatIsMissingIsLeftOut) {
  const fs::path folder = folder_with(yaml_with("mm"), "t,h", "50,");
  std::vector<Problem> problems;
  const SeriesRecording recording = read_series_recording(folder, problems);
  ASSERT_TRUE(problems.empty()) << problems[0].text();
  EXPECT_EQ(recording.conditions[0].times.size(), 9U);
}

TEST(SeriesRecording, AllMistakesOfAFileComeOutTogether) {
  std::string yaml = yaml_with("mm");
  yaml.replace(yaml.find("name: gap"), 9, "name: gip");
  yaml.replace(yaml.find("unit: ms"), 8, "unit: kg");
  EXPECT_EQ(problems_of(folder_with(yaml, "t,h", "50,95")),
            "recording.yaml:11:25 time.unit\nrecording.yaml:13:12 channels[0].name\n");
}

TEST(SeriesRecording, AConditionWithoutAViscosityIsRefused) {
  std::string yaml = yaml_with("mm");
  yaml.replace(yaml.find("name: viscosity, value: \"0.1 Pa s\", uncertainty: \"0.01 Pa s\""), 62,
               "name: gravity, value: 9.81 m s-2");
  EXPECT_EQ(problems_of(folder_with(yaml, "t,h", "50,95")).substr(0, 14), "recording.yaml");
}

TEST(SeriesRecording, AChannelThatNoModelProducesIsRefusedWithWhatThereIs) {
  std::string yaml = yaml_with("mm");
  yaml.replace(yaml.find("name: gap"), 9, "name: pull");
  std::vector<Problem> problems;
  read_series_recording(folder_with(yaml, "t,h", "50,95"), problems);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].line, 13);
  EXPECT_NE(problems[0].text().find("gap"), std::string::npos) << problems[0].text();
}

TEST(SeriesRecording, ConditionsThatContradictThemselvesAreRefused) {
  std::string yaml = yaml_with("mm");
  const std::string value = "{name: viscosity, value: \"0.1 Pa s\", uncertainty: \"0.01 Pa s\"}";
  yaml.replace(yaml.find(value), value.size(), value + ", {name: viscosity, value: 0.2 Pa s}");
  std::vector<Problem> problems;
  read_series_recording(folder_with(yaml, "t,h", "50,95"), problems);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems[0].text().find("gives a value twice"), std::string::npos);
}

TEST(SeriesRecording, AllCommittedOnesAreSound) {
  int count = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(GROUSER_SOURCE_DIR) / "configs/recordings")) {
    if (!is_series_recording(entry.path())) continue;
    std::vector<Problem> problems;
    const SeriesRecording recording = read_series_recording(entry.path(), problems);
    for (const Problem& problem : problems) ADD_FAILURE() << problem.text();
    EXPECT_EQ(recording.name, entry.path().filename().string());
    ++count;
  }
  EXPECT_GE(count, 1);
}

}  // namespace
}  // namespace grouser::diagnosis
