// SPDX-License-Identifier: BSD-3-Clause
#include <signal.h>
#include <sys/wait.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/atomic_file.hpp"
#include "base/run_contract.hpp"
#include "campaign_run.hpp"

namespace grouser {
namespace {

using Json = nlohmann::json;
using LocalCampaign = CampaignRun;

TEST_F(LocalCampaign, RunsToItsEndAndReports) {
  const auto done = submit();
  EXPECT_EQ(done.code, 0) << done.out << done.err;
  expect_undisturbed_result();
  EXPECT_NE(done.out.find("report: "), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(root() / "report" / "report.html"));
  EXPECT_EQ(attempts().size(), 1u + 3u * 3u);
}

TEST_F(LocalCampaign, TheNumberOfChunksDoesNotChangeABit) {
  for (const char* chunks : {"chunks: {count: 7}\n", "chunks: {simulated_time: 50 ms}\n"}) {
    std::filesystem::remove_all(root());
    write_campaign(chunks);
    EXPECT_EQ(submit().code, 0);
    expect_undisturbed_result();
  }
  EXPECT_GT(attempts().size(), 20u);
}

TEST_F(LocalCampaign, WalltimeCutsChunksFurtherAndChangesNoBit) {
  write_campaign("resources: {walltime: 1 s}\nchunks: {count: 1}\n");
  variables["FAKE_STEP_MICROSECONDS"] = "6000";  // 305 steps take two walltimes
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  const Store store = Store::open_read_only(root() / Store::kFileName);
  EXPECT_GE(store.chunks(run("towed").id).size(), 2u);
}

TEST_F(LocalCampaign, ValidateNamesTenMistakesInOnePassAndNoEleventh) {
  write_atomic(directory_.path() / "broken.yaml", R"(grouser: 1
campaign: broken
scheduler: slrum
resources: {ranks: none}
case:
  box: {length: 40 s, width: -12 cm, depth: 10 cm}
  grains:
    density: 2650
    size_curve: [{diameter: 0.4 mm, finer: 0 %}, {diameter: 0.8 mm, finer: 150 %}]
  contact:
    rolling: elastic_plastik
    grain_grain: {restitution: 0, friction: 0.5}
    grain_box: {restitution: 0.5, friction: 0.5}
  bed: {depth: twenty cm}
  grafity: 9.81 m/s2
)");
  const auto refused = grouser({"validate", "broken.yaml"});
  EXPECT_EQ(refused.code, 20);
  std::multiset<std::string> found;
  std::istringstream lines(refused.err);
  for (std::string line; std::getline(lines, line);) {
    const auto from = line.find("broken.yaml:");
    const auto to = line.find(": ", line.find(": ") + 2);
    found.insert(from == std::string::npos ? line : line.substr(from + 12, to - from - 12));
  }
  const std::multiset<std::string> expected{"3:12: scheduler",
                                            "4:20: resources.ranks",
                                            "6:17: case.box.length",
                                            "6:30: case.box.width",
                                            "8:14: case.grains.density",
                                            "9:76: case.grains.size_curve[1].finer",
                                            "11:14: case.contact.rolling",
                                            "12:32: case.contact.grain_grain.restitution",
                                            "14:16: case.bed.depth",
                                            "15:12: case.grafity"};
  EXPECT_EQ(found, expected) << refused.err;
}

TEST_F(LocalCampaign, SubmittingAgainChangesNothing) {
  EXPECT_EQ(submit().code, 0);
  const auto before = attempts().size();
  EXPECT_EQ(submit().code, 0);
  EXPECT_EQ(attempts().size(), before);
}

TEST_F(LocalCampaign, AChangedYamlIsTakenOverOnlyWhenTold) {
  EXPECT_EQ(submit().code, 0);
  const auto file = directory_.path() / "campaign.yaml";
  std::string yaml = read_file(file).value();
  yaml.replace(yaml.find("slip: 20 %"), 10, "slip: 30 %");
  write_atomic(file, yaml);
  const auto refused = submit();
  EXPECT_EQ(refused.code, 20);
  EXPECT_NE(refused.err.find("--update"), std::string::npos);
  EXPECT_NE(refused.err.find("submitted in sweep;"), std::string::npos) << refused.err;
  EXPECT_EQ(runs().size(), 4u);
  const auto updated = grouser({"submit", "campaign.yaml", "--update", "--every", "0.1"});
  EXPECT_EQ(updated.code, 0) << updated.err;
  EXPECT_NE(updated.out.find("1 runs that the YAML no longer has are cancelled; "
                             "their files are kept: slip_20"),
            std::string::npos)
      << updated.out;
  EXPECT_EQ(runs().size(), 5u);
  EXPECT_TRUE(run("slip_20").in_plan);
  const auto status = grouser({"status"});
  EXPECT_NE(status.out.find("4 COMPLETED\n1 runs that the YAML no longer has are left out"),
            std::string::npos)
      << status.out;
  const Json json = Json::parse(grouser({"status", "--json"}).out);
  EXPECT_EQ(json["left_out"], 1);
  EXPECT_EQ(json["runs"].size(), 4u);
}

TEST_F(LocalCampaign, AChangeThatMakesNoNewRunIsNotSwallowed) {
  EXPECT_EQ(submit().code, 0);
  const auto file = directory_.path() / "campaign.yaml";
  std::string yaml = read_file(file).value();
  write_atomic(file, "# a remark\n" + yaml);
  EXPECT_EQ(submit().code, 0);
  yaml.replace(yaml.find("count: 3"), 8, "count: 4");
  write_atomic(file, yaml);
  const auto refused = submit();
  EXPECT_EQ(refused.code, 20);
  EXPECT_NE(refused.err.find("submitted in chunks;"), std::string::npos) << refused.err;
  EXPECT_EQ(grouser({"submit", "campaign.yaml", "--update", "--every", "0.1"}).code, 0);
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
}

TEST_F(LocalCampaign, ADeletedRunDirectoryIsMadeAgain) {
  EXPECT_EQ(submit().code, 0);
  const std::string bed = runs().front().label;
  for (const std::string& label : {bed, std::string("towed")})
    std::filesystem::remove_all(root() / run(label).directory);
  const auto again = submit();
  EXPECT_EQ(again.code, 0) << again.out << again.err;
  for (const std::string& label : {bed, std::string("towed")})
    EXPECT_NE(again.out.find(label + ": its directory is gone; it starts anew"), std::string::npos)
        << again.out;
  expect_undisturbed_result();
  EXPECT_EQ(attempts().size(), 10u + 1u + 3u);
}

TEST_F(LocalCampaign, AMistypedVerbIsAnsweredWithTheNearest) {
  const auto refused = grouser({"sbmit", "campaign.yaml"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("did you mean 'submit'?"), std::string::npos) << refused.err;
  EXPECT_EQ(grouser({"tick", "--every", "nan"}).code, 2);
}

TEST_F(LocalCampaign, OutputThatCannotBeWrittenIsAnError) {
  EXPECT_EQ(submit().code, 0);
  for (const char* words : {"status", "query 'SELECT 1'", "--help"}) {
    const auto full =
        run_command({"bash", "-c", std::string(GROUSER_PROGRAM) + " " + words + " >/dev/full"},
                    20.0, directory_.path());
    EXPECT_EQ(full.code, 40) << words;
    EXPECT_NE(full.err.find("standard output cannot be written"), std::string::npos) << full.err;
  }
}

TEST_F(LocalCampaign, ADryRunWritesNothing) {
  const auto shown = grouser({"submit", "campaign.yaml", "--dry-run"});
  EXPECT_EQ(shown.code, 0) << shown.err;
  EXPECT_NE(shown.out.find("=== slip_20"), std::string::npos);
  EXPECT_NE(shown.out.find("'--until-time'"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(directory_.path() / "runs"));
}

TEST_F(LocalCampaign, ABrokenYamlMakesNothing) {
  write_campaign("resources: {ranks: many}\n");
  EXPECT_EQ(submit().code, 20);
  EXPECT_FALSE(std::filesystem::exists(directory_.path() / "runs"));
}

TEST_F(LocalCampaign, AMissingEngineIsSaidBeforeAnythingIsMade) {
  variables["GROUSER_ENGINE"] = "/no/such/engine";
  const auto refused = submit();
  EXPECT_EQ(refused.code, 20);
  EXPECT_NE(refused.err.find("/no/such/engine: is not a program"), std::string::npos);
}

TEST_F(LocalCampaign, StopLeavesACheckpointAndResumeGoesOnFromIt) {
  variables["FAKE_STEP_MICROSECONDS"] = "5000";
  EXPECT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const std::string bed = runs().front().label;
  ASSERT_TRUE(wait_for(
      [&] { return std::filesystem::exists(root() / run(bed).directory / run_files::kProgress); }));
  EXPECT_EQ(grouser({"stop", "bed-*", "--every", "0.1"}).code, 0);
  EXPECT_EQ(run(bed).state, State::kHeld);
  EXPECT_EQ(run(bed).reason, "stopped on request");
  const auto step = run(bed).step;
  EXPECT_GT(step, 0);
  EXPECT_EQ(grouser({"status", "--check"}).code, 1);
  variables.erase("FAKE_STEP_MICROSECONDS");
  EXPECT_EQ(grouser({"resume", "--all"}).code, 0);
  EXPECT_EQ(submit().code, 0);
  EXPECT_EQ(attempts()[1].start_step, step);
  expect_undisturbed_result();
}

TEST_F(LocalCampaign, CancelKillsAndResumeGoesOn) {
  variables["FAKE_HANG_AT"] = "50";
  EXPECT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const std::string bed = runs().front().label;
  ASSERT_TRUE(wait_for(
      [&] { return std::filesystem::exists(root() / run(bed).directory / run_files::kProgress); }));
  EXPECT_EQ(grouser({"cancel", bed}).code, 2);  // nobody said yes
  EXPECT_EQ(grouser({"cancel", bed, "--yes", "--every", "0.1"}).code, 0);
  EXPECT_EQ(run(bed).state, State::kCancelled);
  variables.erase("FAKE_HANG_AT");
  EXPECT_EQ(grouser({"resume", bed}).code, 0);
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
}

TEST_F(LocalCampaign, CtrlCLeavesJobsRunningAndTickGoesOn) {
  variables["FAKE_STEP_MICROSECONDS"] = "3000";
  const pid_t manager = start({"submit", "campaign.yaml"});
  ASSERT_TRUE(wait_for([&] { return has_runs(); }));
  ASSERT_TRUE(wait_for([&] {
    const auto active = Store::open_read_only(root() / Store::kFileName).active_attempts();
    return !active.empty() && active.front().state == State::kRunning;
  }));
  ::kill(manager, SIGINT);
  int status = 0;
  ::waitpid(manager, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const auto before = attempts();
  ASSERT_EQ(before.size(), 1u);
  EXPECT_EQ(before.front().state, State::kRunning);
  EXPECT_EQ(grouser({"tick", "--wait", "--every", "0.1"}).code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(attempts().size(), 10u);
}

TEST_F(LocalCampaign, StatusSaysThatEverythingWasKilledAndWritesNothing) {
  variables["FAKE_HANG_AT"] = "50";
  EXPECT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const std::string bed = runs().front().label;
  ASSERT_TRUE(wait_for(
      [&] { return std::filesystem::exists(root() / run(bed).directory / run_files::kProgress); }));
  const auto alive = grouser({"status", "--check"});
  EXPECT_EQ(alive.code, 0);
  EXPECT_NE(alive.out.find("  RUNNING  "), std::string::npos) << alive.out;
  kill_local_jobs();
  ASSERT_TRUE(wait_for([&] { return grouser({"status", "--check"}).code == 1; }));
  const auto dead = grouser({"status"});
  EXPECT_EQ(dead.code, 0);
  EXPECT_EQ(dead.out.find("RUNNING"), std::string::npos) << dead.out;
  EXPECT_EQ(dead.out.find("QUEUED"), std::string::npos) << dead.out;
  EXPECT_NE(dead.out.find("attempt 1: ended without an outcome (killed)"), std::string::npos)
      << dead.out;
  EXPECT_NE(dead.out.find("1 job has ended since the last tick; unless a manager is at work, go on "
                          "with\n  grouser tick -C " +
                          root().string()),
            std::string::npos)
      << dead.out;
  const Json json = Json::parse(grouser({"status", "--json"}).out);
  EXPECT_EQ(json["unsettled"], 1);
  EXPECT_EQ(json["counts"], Json::parse(R"({"READY": 1, "PLANNED": 3})"));
  EXPECT_EQ(json["runs"][0]["unsettled"], true);
  EXPECT_TRUE(json["runs"][0]["progress"].is_null());
  EXPECT_TRUE(is_active(attempts().front().state));
  variables.erase("FAKE_HANG_AT");
  EXPECT_EQ(submit().code, 0);
  EXPECT_EQ(Json::parse(grouser({"status", "--json"}).out)["unsettled"], 0);
  expect_undisturbed_result();
}

TEST_F(LocalCampaign, StatusSeesAnEndThatNoTickHasSeen) {
  EXPECT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const auto exit = root() / ".local" / ("g" + attempts().front().token) / "exit";
  ASSERT_TRUE(wait_for([&] { return std::filesystem::exists(exit); }));
  const auto seen = grouser({"status", "--check"});
  EXPECT_EQ(seen.code, 0);
  EXPECT_NE(seen.out.find("1 COMPLETED"), std::string::npos) << seen.out;
  EXPECT_NE(seen.out.find("1/1"), std::string::npos) << seen.out;
  EXPECT_TRUE(is_active(attempts().front().state));
  EXPECT_EQ(grouser({"tick"}).code, 0);
  EXPECT_EQ(runs().front().state, State::kCompleted);
}

TEST_F(LocalCampaign, StatusQueryAndShowSpeakJson) {
  EXPECT_EQ(submit().code, 0);
  const Json status = Json::parse(grouser({"status", "--json"}).out);
  EXPECT_EQ(status["schema"], 1);
  EXPECT_EQ(status["counts"]["COMPLETED"], 4);
  EXPECT_EQ(status["runs"][1]["axes"]["slip"], "towed");
  const Json query = Json::parse(
      grouser({"query", "SELECT run, attempts FROM v_ledger WHERE run = 'towed'", "--json"}).out);
  EXPECT_EQ(query["rows"][0]["attempts"], 3);
  EXPECT_EQ(grouser({"query", "DELETE FROM run"}).code, 20);
  EXPECT_EQ(grouser({"query", "SELECT 1 AS a, 2 AS a", "--json"}).code, 20);
  const Json odd =
      Json::parse(grouser({"query", "SELECT 9e999 AS infinite, x'41ff' AS bytes", "--json"}).out);
  EXPECT_TRUE(odd["rows"][0]["infinite"].is_null());
  EXPECT_EQ(odd["rows"][0]["bytes"], "A\xEF\xBF\xBD");
  const Json expanded =
      Json::parse(grouser({"expand", "campaign.yaml", "--case", "towed", "--json"}).out);
  EXPECT_EQ(expanded["case"]["box"]["length"], 0.4);
  const Json show = Json::parse(grouser({"show", "slip_*", "--json"}).out);
  EXPECT_EQ(show["runs"].size(), 2u);
  EXPECT_EQ(show["runs"][0]["chunks"].size(), 3u);
  const auto unknown = grouser({"show", "slip_21"});
  EXPECT_EQ(unknown.code, 20);
  EXPECT_NE(unknown.err.find("did you mean slip_20?"), std::string::npos);
}

TEST_F(LocalCampaign, OnlySoManyRunAtOnce) {
  write_campaign("resources: {concurrent: 1}\n");
  variables["FAKE_STEP_MICROSECONDS"] = "500";
  const pid_t manager = start({"submit", "campaign.yaml", "--every", "0.05"});
  ASSERT_TRUE(wait_for([&] { return has_runs(); }));
  std::size_t most = 0;
  int status = 0;
  while (::waitpid(manager, &status, WNOHANG) == 0)
    most =
        std::max(most, Store::open_read_only(root() / Store::kFileName).active_attempts().size());
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(most, 1u);
}

}  // namespace
}  // namespace grouser
