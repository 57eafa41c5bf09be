// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "campaign/report/csv.hpp"
#include "campaign/report/run_output.hpp"
#include "campaign/report/tables.hpp"
#include "campaign/report/words.hpp"
#include "synthetic.hpp"

namespace grouser {
namespace {

// The noise has memory 0.8 and steps uniform in +-0.03: the mean of 120 rows has a standard
// deviation of 0.03 / sqrt(3) / 0.2 / sqrt(120) = 0.008; 4 of them, averaged over two seeds.
constexpr double kSampling = 4.0 * 0.008 / 1.414;

const Comparison& comparison_of(const ReportData& data, const Analysis& analysis,
                                const std::string& condition, const std::string& kind,
                                Observable observable) {
  for (const Comparison& c : analysis.comparisons) {
    const RecordingPoint& point = data.recordings[c.recording].points[c.point];
    if (point.condition == condition && point.kind == kind && point.observable == observable)
      return c;
  }
  throw std::runtime_error("no such comparison");
}

RunSeries ramp(int rows) {
  RunSeries series;
  for (int i = 1; i <= rows; ++i) {
    series.phase.push_back(i <= 10 ? "wheel_settling" : "driving");
    series.time.push_back(0.1 * i);
    series.travel.push_back(i <= 10 ? 0.0 : 0.01 * (i - 10));
    series.forward_speed.push_back(0.1);
    series.spin.push_back(1.0);
    for (auto& values : series.observables) values.push_back(i);
  }
  return series;
}

WheelCase wheel_of(double travel, double average) {
  WheelCase wheel;
  wheel.travel = travel;
  wheel.average_travel = average;
  return wheel;
}

TEST(AveragingWindow, IsTheLastPartOfTheTravel) {
  const Window window = averaging_window(ramp(50), wheel_of(0.4, 0.1), true);
  EXPECT_TRUE(window.is_complete);
  EXPECT_EQ(window.rows(), 10u);
  EXPECT_NEAR(window.from_travel, 0.3, 1e-12);
  EXPECT_NEAR(window.to_time, 5.0, 1e-12);
}

TEST(AveragingWindow, OfARunUnderWayIsIncomplete) {
  const Window window = averaging_window(ramp(45), wheel_of(0.4, 0.1), false);
  EXPECT_FALSE(window.is_complete);
  EXPECT_EQ(window.rows(), 5u);
  EXPECT_EQ(averaging_window(ramp(20), wheel_of(0.4, 0.1), false).rows(), 0u);
}

TEST(AveragingWindow, OfASteadyStopEndsWhereTheTravelEnds) {
  const Window window = averaging_window(ramp(30), wheel_of(0.4, 0.1), true);
  EXPECT_TRUE(window.is_complete);
  EXPECT_NEAR(window.to_travel, 0.2, 1e-12);
}

TEST(AveragingWindow, OfNothingIsEmpty) {
  for (const bool is_finished : {false, true}) {
    EXPECT_EQ(averaging_window(RunSeries{}, wheel_of(0.4, 0.1), is_finished).rows(), 0u);
    EXPECT_FALSE(averaging_window(ramp(8), wheel_of(0.4, 0.1), is_finished).is_complete);
  }
}

TEST(Analysis, FindsTheMeansThatWerePutIn) {
  const ReportData data = synthetic::campaign(2);
  const Analysis analysis = analyse(data);
  ASSERT_EQ(analysis.points.size(), 6u);
  for (const PointResult& point : analysis.points) {
    SCOPED_TRACE(point.label);
    const synthetic::Truth truth = synthetic::truth_of(point.label);
    EXPECT_EQ(point.complete, 2u);
    EXPECT_NEAR(point.of(Observable::kPullCoefficient).mean, truth.pull, kSampling);
    EXPECT_NEAR(point.of(Observable::kGrossCoefficient).mean, truth.gross, kSampling);
    EXPECT_NEAR(point.of(Observable::kSinkage).mean, truth.sinkage, 0.02 * truth.sinkage);
    EXPECT_NEAR(point.slip.mean, truth.slip, 1e-9);
    EXPECT_EQ(point.is_towed, point.label == "towed");
  }
}

TEST(Analysis, ScatterIsNeverBelowTheErrorWithinTheRuns) {
  ReportData data = synthetic::campaign(2);
  data.runs[1].series = data.runs[0].series;  // two seeds that agree by chance
  const Analysis analysis = analyse(data);
  const PointResult& point = analysis.points[0];
  EXPECT_DOUBLE_EQ(point.of(Observable::kPullCoefficient).deviation, 0.0);
  EXPECT_DOUBLE_EQ(point.chance_of(Observable::kPullCoefficient),
                   analysis.runs[0].of(Observable::kPullCoefficient).error);
}

TEST(Analysis, TowedIsComparedWithTowedAndSlipWithSlip) {
  const ReportData data = synthetic::campaign(2);
  const Analysis analysis = analyse(data);
  const Comparison& towed =
      comparison_of(data, analysis, "towed", "lab", Observable::kPullCoefficient);
  EXPECT_EQ(towed.match, Match::kTowed);
  EXPECT_NEAR(towed.slip, synthetic::truth_of("towed").slip, 1e-9);
  const Comparison& driven =
      comparison_of(data, analysis, "slip_20", "lab", Observable::kGrossCoefficient);
  EXPECT_EQ(driven.match, Match::kSlip);
  EXPECT_NEAR(driven.difference, 0.24 - 0.31, kSampling);
  EXPECT_FALSE(driven.is_inside());
}

TEST(Analysis, BetweenPointsItInterpolatesAndBeyondItDoesNot) {
  ReportData data = synthetic::campaign(2);
  data.recordings[0].points = {
      {"between", 0.3, "lab", Observable::kPullCoefficient, 0.2, 0.01, kNaN},
      {"beyond", 0.8, "lab", Observable::kPullCoefficient, 0.2, kNaN, kNaN}};
  const Analysis analysis = analyse(data);
  const double low = analysis.points[4].of(Observable::kPullCoefficient).mean;
  const double high = analysis.points[5].of(Observable::kPullCoefficient).mean;
  EXPECT_EQ(analysis.comparisons[0].match, Match::kInterpolated);
  EXPECT_NEAR(analysis.comparisons[0].campaign, 0.5 * (low + high), 1e-9);
  EXPECT_GT(analysis.comparisons[0].tolerance, 2.0 * 0.01);
  EXPECT_EQ(analysis.comparisons[1].match, Match::kNone);
}

TEST(Analysis, RunsThatHaveNotReachedTheirWindowAreNotAveraged) {
  ReportData data = synthetic::campaign(2);
  RunData& run = data.runs[0];
  run.is_finished = false;
  run.state = "RUNNING";
  run.series = parse_series(synthetic::series_text("braked_20", run.input, 1, 0.3), run.label);
  data.runs[2] = RunData{};  // planned, nothing there yet
  data.runs[2].label = "towed-s1";
  data.runs[2].state = "PLANNED";
  data.runs[2].axes = {{"slip", "towed"}, {"seed", "s1"}};
  const Analysis analysis = analyse(data);
  EXPECT_EQ(analysis.points[0].complete, 1u);
  EXPECT_EQ(analysis.points[1].complete, 1u);
  EXPECT_EQ(progress_in_words(data), "10 of 12 runs are finished (others: 1 PLANNED, 1 RUNNING).");
}

TEST(Analysis, AnEmptyCampaignIsAllowed) {
  ReportData data;
  const Analysis analysis = analyse(data);
  EXPECT_TRUE(analysis.points.empty());
  EXPECT_EQ(progress_in_words(data), "The campaign has no wheel runs.");
  EXPECT_EQ(result_in_words(data, analysis, "lab"), "");
}

TEST(Words, NameWhatIsInsideAndTheLargestDifference) {
  const ReportData data = synthetic::campaign(2);
  const std::string text = result_in_words(data, analyse(data), "lab");
  EXPECT_NE(text.find("2 of 3 laboratory values lie inside the seed scatter"), std::string::npos)
      << text;
  EXPECT_NE(text.find("gross coefficient at 20\u00A0% slip, 24."), std::string::npos) << text;
  EXPECT_NE(text.find("here against 31.0\u00A0% (−6."), std::string::npos) << text;
}

TEST(Tables, HoldTheNumbersOfTheAnalysis) {
  const ReportData data = synthetic::campaign(2);
  const Analysis analysis = analyse(data);
  const CsvTable results = parse_csv(results_csv(data, analysis));
  const CsvTable means = parse_csv(means_csv(analysis));
  const CsvTable compare = parse_csv(compare_csv(data, analysis));
  ASSERT_EQ(results.rows.size(), 12u);
  ASSERT_EQ(means.rows.size(), 6u);
  ASSERT_EQ(compare.rows.size(), 6u);
  for (const CsvTable* table : {&results, &means, &compare})
    for (const auto& row : table->rows) EXPECT_EQ(row.size(), table->header.size());
  const auto at = [](const CsvTable& table, std::size_t row, const char* column) {
    return table.rows[row][table.column(column).value()];
  };
  EXPECT_EQ(at(results, 3, "axis:slip"), "towed");
  EXPECT_EQ(at(results, 3, "axis:seed"), "s2");
  EXPECT_EQ(at(results, 3, "window_complete"), "yes");
  EXPECT_EQ(number_of(at(means, 4, "pull_coefficient [1]")),
            0.5 * (number_of(at(results, 8, "pull_coefficient [1]")) +
                   number_of(at(results, 9, "pull_coefficient [1]"))));
  EXPECT_EQ(at(compare, 0, "recorded"), "0.17");
  EXPECT_EQ(at(compare, 0, "uncertainty"), "");
  EXPECT_EQ(at(compare, 1, "inside"), "no");
  EXPECT_NEAR(number_of(at(compare, 2, "difference")),
              number_of(at(means, 1, "pull_coefficient [1]")) + 0.12, 1e-15);
}

TEST(Tables, SummaryNamesEveryPointAndRecordedValue) {
  const ReportData data = synthetic::campaign(2);
  const std::string text = summary_text(data, analyse(data));
  for (const std::string& point : synthetic::point_labels())
    EXPECT_NE(text.find(point), std::string::npos) << text;
  EXPECT_NE(text.find("31.0"), std::string::npos) << text;
}

}  // namespace
}  // namespace grouser
