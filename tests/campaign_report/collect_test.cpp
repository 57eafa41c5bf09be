// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/collect.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "base/run_contract.hpp"
#include "campaign/report/csv.hpp"
#include "campaign/report/report.hpp"
#include "campaign/store/store.hpp"
#include "markup.hpp"
#include "synthetic.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// A campaign root with a database, two runs of one point and their files: what the manager and the
/// engine leave behind.
class CampaignOnDisk : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    root_ = fs::path(testing::TempDir()) / ("report_" + name);
    fs::remove_all(root_);
    fs::create_directories(root_);
    std::ofstream(root_ / "campaign.yaml") << "report: {recordings: [{path: " << GROUSER_SOURCE_DIR
                                           << "/configs/recordings/jelinek2020_wheel_71cm}]}\n";
    Store store = Store::open(root_ / Store::kFileName);
    store.take_lease({"host", "boot", 1, 1, 0}, [](const LeaseHolder&) { return true; });
    CampaignRow campaign;
    campaign.name = "test";
    campaign.title = "Test <campaign>";
    campaign.source = root_ / "campaign.yaml";
    campaign.engine = "/opt/grouser-engine";
    campaign.created_at = 1.0e9;
    store.replace_plan(
        {campaign, {}, {new_run(1, State::kCompleted), new_run(2, State::kRunning)}, {}});
    add_attempt(store, store.runs()[0]);
    write_run(1, 0.4);
    write_run(2, 0.3);
  }

  static NewRun new_run(int seed, State state) {
    NewRun run;
    run.row.label = "slip_20_s" + std::to_string(seed);
    run.row.directory = fs::path("runs") / run.row.label;
    run.row.key = "0123456789abcdef";
    run.row.axes = {{"slip", "slip_20"}, {"seed", "s" + std::to_string(seed)}};
    run.row.state = state;
    run.row.state_hash = "feed0000beef0000";
    run.row.particles = 12700;
    run.chunk_ends = {std::nullopt};
    return run;
  }

  static void add_attempt(Store& store, const RunRow& run) {
    AttemptRow attempt;
    attempt.run = run.id;
    attempt.chunk = store.chunks(run.id)[0].id;
    attempt.token = "abcdefgh";
    attempt.state = State::kCompleted;
    attempt.reason = "reached its end";
    attempt.running_at = 1.0e9 + 60.0;
    attempt.wall_seconds = 20.0;
    attempt.compute_seconds = 16.0;
    attempt.checkpoint_seconds = 1.5;
    attempt.steps_done = 4000;
    attempt.particles = 12700;
    attempt.engine_hash = "e0e0e0e0e0e0e0e0";
    store.add_attempt(attempt, run, store.chunks(run.id)[0]);
  }

  void write_run(int seed, double travel) const {
    const fs::path folder = root_ / "runs" / ("slip_20_s" + std::to_string(seed));
    fs::create_directories(folder / run_files::kEvents);
    const Case input = synthetic::case_of("slip_20", seed);
    std::ofstream(folder / run_files::kCase) << emit_yaml(write_case(input));
    std::ofstream(folder / run_files::kSeries)
        << synthetic::series_text("slip_20", input, seed, travel);
    std::ofstream(folder / run_files::kSlice) << synthetic::slice_text(input, seed);
    Event event;
    event.token = "abcdefgh";
    event.kind = "started";
    event.host = "node17";
    write_event(folder, event);
  }

  fs::path root_;
};

TEST_F(CampaignOnDisk, BecomesAReportOfFourFiles) {
  const fs::path html = write_report({root_});
  EXPECT_EQ(html, root_ / "report" / "report.html");
  const std::string page = text_of(html);
  EXPECT_EQ(markup::first_fault(page), "");
  EXPECT_NE(page.find("Test &lt;campaign&gt;"), std::string::npos);
  const CsvTable results = parse_csv(text_of(root_ / "report/results.csv"));
  ASSERT_EQ(results.rows.size(), 2u);
  EXPECT_EQ(results.rows[0][results.column("window_complete").value()], "yes");
  EXPECT_EQ(results.rows[1][results.column("window_complete").value()], "no");
  const CsvTable means = parse_csv(text_of(root_ / "report/means.csv"));
  ASSERT_EQ(means.rows.size(), 1u);
  EXPECT_EQ(means.rows[0][means.column("runs_averaged [1]").value()], "1");
  EXPECT_EQ(means.rows[0][means.column("pull_coefficient [1]").value()],
            results.rows[0][results.column("pull_coefficient [1]").value()]);
  EXPECT_EQ(parse_csv(text_of(root_ / "report/compare.csv")).rows.size(), 6u);
}

TEST_F(CampaignOnDisk, GivesLedgerAndProvenance) {
  const ReportData data = collect_report(root_, 1.0e9 + 3600.0);
  EXPECT_TRUE(data.warnings.empty());
  EXPECT_EQ(data.made_at, "2001-09-09 02:46 UTC");
  ASSERT_EQ(data.runs.size(), 2u);
  ASSERT_EQ(data.runs[0].attempts.size(), 1u);
  const AttemptData& attempt = data.runs[0].attempts[0];
  EXPECT_EQ(attempt.chunk, 1);
  EXPECT_EQ(attempt.host, "node17");
  EXPECT_EQ(attempt.outcome, "reached its end");
  EXPECT_DOUBLE_EQ(attempt.compute_seconds, 16.0);
  const auto provenance = [&](const std::string& name) {
    for (const auto& [key, value] : data.provenance)
      if (key == name) return value;
    return std::string("missing");
  };
  EXPECT_EQ(provenance("Hosts"), "1");
  EXPECT_EQ(provenance("Seeds of the filling"), "1, 2");
  EXPECT_EQ(provenance("Hash of the engine's program"), "e0e0e0e0e0e0e0e0");
}

TEST_F(CampaignOnDisk, DamagedAndMissingFilesBecomeWarnings) {
  std::ofstream(root_ / "runs/slip_20_s1" / run_files::kSeries) << "garbage\n1\n";
  std::ofstream(root_ / "runs/slip_20_s2" / run_files::kCase) << "box: [";
  fs::remove(root_ / "runs/slip_20_s2" / run_files::kSlice);
  fs::remove(root_ / "campaign.yaml");
  const ReportData data = collect_report(root_, 1.0e9);
  EXPECT_EQ(data.warnings.size(), 3u);
  EXPECT_TRUE(data.runs[1].slice.grains.empty());
  EXPECT_EQ(markup::first_fault(text_of(write_report({root_}))), "");
}

TEST_F(CampaignOnDisk, RunsThatTheYamlNoLongerHasAreLeftOut) {
  Store store = Store::open(root_ / Store::kFileName);
  store.take_lease({"host", "boot", 1, 1, 0}, [](const LeaseHolder&) { return true; });
  Change change;
  change.run = store.runs()[0];
  change.run->in_plan = false;
  store.apply(change);
  const ReportData data = collect_report(root_, 1.0e9);
  ASSERT_EQ(data.runs.size(), 1u);
  EXPECT_EQ(data.runs[0].label, "slip_20_s2");
  EXPECT_TRUE(data.runs[0].attempts.empty()) << "the attempt is of the other run";
  write_report({root_});
  EXPECT_EQ(parse_csv(text_of(root_ / "report/results.csv")).rows.size(), 1u);
}

// The user's file has changed since, and lies elsewhere.
TEST_F(CampaignOnDisk, SettingsAreThoseThatWereSubmitted) {
  fs::create_directories(root_ / "home" / "lab");
  std::ofstream(root_ / "home" / "c.yaml") << "report: {horizontal: powered}\n";
  std::ofstream(root_ / "campaign.yaml")
      << "report:\n  horizontal: bounded\n  recordings:\n    - path: lab\n    - path: nowhere\n";
  const fs::path committed =
      fs::path(GROUSER_SOURCE_DIR) / "configs/recordings/jelinek2020_wheel_71cm";
  fs::copy(committed, root_ / "home" / "lab", fs::copy_options::recursive);
  Store store = Store::open(root_ / Store::kFileName);
  store.take_lease({"host", "boot", 1, 1, 0}, [](const LeaseHolder&) { return true; });
  CampaignRow campaign = store.campaign();
  campaign.source = root_ / "home" / "c.yaml";
  store.replace_plan({campaign, {}, {}, {}});
  const ReportData data = collect_report(root_, 1.0e9);
  EXPECT_EQ(data.settings.horizontal, "bounded");
  EXPECT_EQ(data.recordings.size(), 1u) << "paths count from the user's file";
  ASSERT_EQ(data.warnings.size(), 1u);
  EXPECT_EQ(data.warnings[0].find((root_ / "campaign.yaml").string() +
                                  ":5:13: report.recordings[1].path: " +
                                  (root_ / "home/nowhere/recording.yaml").string()),
            0u)
      << data.warnings[0];
}

TEST_F(CampaignOnDisk, SummaryIsForATerminal) {
  const std::string text = summary_table({root_});
  EXPECT_NE(text.find("slip_20       1/2     20.0"), std::string::npos) << text;
}

TEST(CollectReport, WithoutADatabaseItSaysSo) {
  EXPECT_THROW(collect_report("/nonexistent", 0.0), std::runtime_error);
}

}  // namespace
}  // namespace grouser
