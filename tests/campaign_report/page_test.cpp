// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/page.hpp"

#include <gtest/gtest.h>

#include "campaign/report/run_output.hpp"
#include "markup.hpp"
#include "synthetic.hpp"

namespace grouser {
namespace {

std::string page_of(const ReportData& data) { return report_html(data, analyse(data)); }

TEST(Page, IsWellFormed) { EXPECT_EQ(markup::first_fault(page_of(synthetic::campaign(2))), ""); }

TEST(Page, ShowsCurvesSeriesAndPictures) {
  const std::string page = page_of(synthetic::campaign(2));
  EXPECT_EQ(markup::count_of(page, "data-series=\"mean\""), 3) << "pull, gross, sinkage";
  EXPECT_EQ(markup::count_of(page, "data-series=\"scatter\""), 3);
  EXPECT_EQ(markup::count_of(page, "data-series=\"run\""), 3 * 12);
  EXPECT_EQ(markup::count_of(page, "data-series=\"towed\""), 3);
  EXPECT_EQ(markup::count_of(page, "data-series=\"lab\""), 3);
  EXPECT_EQ(markup::count_of(page, "data-series=\"paper_dem\""), 3);
  EXPECT_EQ(markup::count_of(page, "data-series=\"window\""), 2 * 12);
  EXPECT_EQ(markup::count_of(page, "data-series=\"wheel\""), 6) << "one picture per point";
  EXPECT_LT(page.size(), 2000000u);
}

TEST(Page, LoadsNothingFromElsewhere) {
  const std::string page = page_of(synthetic::campaign(1));
  for (const char* const part : {"http://", "https://", "src=", "<script", "@import", "url("})
    EXPECT_EQ(page.find(part), std::string::npos) << part;
}

TEST(Page, TextFromUsersStaysText) {
  const std::string attack = "\"><script>alert(1)</script><img src=x onerror='a'>&";
  ReportData data = synthetic::campaign(1);
  data.name = data.title = data.made_at = attack;
  data.settings.neglected = {attack};
  data.settings.scatter_axis = attack;
  data.warnings = {attack};
  data.provenance = {{attack, attack}};
  for (RunData& run : data.runs) {
    run.label = run.state = run.reason = run.key = run.state_hash = attack;
    for (auto& [axis, label] : run.axes) axis = label = label + attack;
    for (AttemptData& attempt : run.attempts)
      attempt.state = attempt.outcome = attempt.restart_hash = attempt.state_hash = attack;
    run.input.wheel.stl_file = attack;
  }
  Recording& recording = data.recordings[0];
  recording.name = recording.title = recording.citation = recording.licence = attack;
  recording.provenance = recording.soil = attack;
  recording.caveats = {attack};
  for (RecordingPoint& point : recording.points) point.condition = attack;
  const std::string page = page_of(data);
  EXPECT_EQ(markup::first_fault(page), "");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("<img"), std::string::npos);
}

TEST(Page, ShowsACampaignThatHasNotBegun) {
  ReportData data = synthetic::campaign(1);
  for (RunData& run : data.runs) {
    run.is_finished = false;
    run.state = "PLANNED";
    run.series = RunSeries{};
    run.slice = BedSlice{};
    run.attempts.clear();
    run.has_case = false;
    run.input = Case{};
  }
  const std::string page = page_of(data);
  EXPECT_EQ(markup::first_fault(page), "");
  EXPECT_NE(page.find("0 of 6 runs are finished"), std::string::npos);
  EXPECT_NE(page.find("No time series yet"), std::string::npos);
  EXPECT_EQ(page.find("<section id=\"pictures\""), std::string::npos);
  EXPECT_EQ(page.find("href=\"#pictures\""), std::string::npos) << "a link to nothing";
}

TEST(Page, MarksARunThatIsNotAveraged) {
  ReportData data = synthetic::campaign(2);
  RunData& run = data.runs[0];
  run.is_finished = false;
  run.state = "HELD";
  run.reason = "quota exceeded";
  run.series = parse_series(synthetic::series_text("braked_20", run.input, 1, 0.3), run.label);
  const std::string page = page_of(data);
  EXPECT_EQ(markup::first_fault(page), "");
  EXPECT_EQ(markup::count_of(page, "data-series=\"partial-run\""), 3);
  EXPECT_NE(page.find("quota exceeded"), std::string::npos);
  EXPECT_NE(page.find("averaging window is not complete"), std::string::npos);
}

TEST(Page, WarnsOfARunThatIsNotSteady) {
  ReportData data = synthetic::campaign(1);
  EXPECT_EQ(page_of(data).find("Not steady"), std::string::npos);
  RunSeries& series = data.runs[4].series;
  std::vector<double>& sinkage = series.observables[index_of(Observable::kSinkage)];
  for (std::size_t i = 0; i < series.size(); ++i) sinkage[i] += 0.05 * series.travel[i];
  const std::string page = page_of(data);
  EXPECT_NE(page.find("Not steady within the averaging window: sinkage in 1 run."),
            std::string::npos);
  EXPECT_NE(page.find("rises by 10."), std::string::npos);
}

TEST(Page, OfAnEmptyCampaignIsWellFormed) {
  EXPECT_EQ(markup::first_fault(page_of(ReportData{})), "");
}

TEST(Page, TellsWhatVariesFromWhatIsCommon) {
  const std::string page = page_of(synthetic::campaign(2));
  EXPECT_NE(page.find("<code>wheel.slip</code></td><td>−0.2, 0, 0.1, 0.2, 0.4</td>"),
            std::string::npos);
  EXPECT_NE(page.find("<code>wheel.load</code></td><td class=\"number\">1922</td><td>N</td>"),
            std::string::npos);
}

}  // namespace
}  // namespace grouser
