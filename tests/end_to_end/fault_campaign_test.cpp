// SPDX-License-Identifier: BSD-3-Clause
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <random>
#include <thread>

#include "base/atomic_file.hpp"
#include "campaign_run.hpp"

namespace grouser {
namespace {

using FaultyCampaign = CampaignRun;

TEST_F(FaultyCampaign, KilledEnginesGoOnFromTheirCheckpoints) {
  variables["FAKE_KILL_AT"] = "7,33,150,211,290";
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(run("towed").failures, 0);
}

TEST_F(FaultyCampaign, ADamagedCheckpointIsWalkedBackFrom) {
  variables["FAKE_ONLY"] = "towed";
  variables["FAKE_KILL_AT"] = "150";
  write_campaign("retries: {infrastructure: 0}\n");  // stays FAILED where the kill left it
  EXPECT_EQ(submit().code, 1);
  const auto checkpoints = root() / run("towed").directory / "checkpoints";
  write_atomic(checkpoints / run("towed").checkpoint, "torn");
  EXPECT_EQ(grouser({"resume", "--all"}).code, 0);
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
}

class ManagerKilled : public CampaignRun, public ::testing::WithParamInterface<const char*> {};

TEST_P(ManagerKilled, AtThisPointOfASubmissionLosesAndDoublesNothing) {
  variables["FAKE_STEP_MICROSECONDS"] = "200";
  variables["GROUSER_FAULT"] = GetParam();
  // Every manager dies at that point, some of them several submissions further on.
  for (int life = 0; life < 4; ++life) EXPECT_EQ(submit().code, 137) << GetParam();
  variables.erase("GROUSER_FAULT");
  const auto done = submit();
  EXPECT_EQ(done.code, 0) << done.out << done.err;
  expect_undisturbed_result();
  // What did reach the scheduler was adopted: no attempt that ran was thrown away.
  for (const AttemptRow& attempt : attempts())
    EXPECT_NE(attempt.state, State::kFailed) << attempt.reason;
}

INSTANTIATE_TEST_SUITE_P(Points, ManagerKilled,
                         ::testing::Values("after_tx1", "after_fence", "after_script",
                                           "after_submit", "after_tx2", "before_settle",
                                           "after_settle"),
                         [](const auto& point) { return std::string(point.param); });

class LaunchKilled : public CampaignRun, public ::testing::WithParamInterface<const char*> {};

TEST_P(LaunchKilled, AtThisPointCanBeSubmittedAgain) {
  variables["GROUSER_FAULT"] = GetParam();
  EXPECT_EQ(submit().code, 137);
  variables.erase("GROUSER_FAULT");
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
}

INSTANTIATE_TEST_SUITE_P(Points, LaunchKilled,
                         ::testing::Values("after_directories", "after_runs", "after_cancels"),
                         [](const auto& point) { return std::string(point.param); });

TEST_F(FaultyCampaign, ManagersKilledAtRandomTimesLoseAndDoubleNothing) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  variables["FAKE_STEP_MICROSECONDS"] = "500";
  variables["FAKE_KILL_AT"] = "40,170";
  for (int life = 0; life < 12; ++life) {
    const pid_t manager = start({"submit", "campaign.yaml", "--every", "0.02", "--grace", "0.5"});
    std::this_thread::sleep_for(std::chrono::milliseconds(5 + random() % 250));
    ::kill(manager, SIGKILL);
    ::waitpid(manager, nullptr, 0);
  }
  const auto done = submit();
  EXPECT_EQ(done.code, 0) << "seed " << seed << "\n" << done.out << done.err;
  expect_undisturbed_result();
}

TEST_F(FaultyCampaign, TwoManagersAtOnceDoNotDisturbEachOther) {
  variables["FAKE_STEP_MICROSECONDS"] = "500";
  const std::vector<std::string> words{"submit", "campaign.yaml", "--every", "0.02"};
  const pid_t first = start(words);
  const pid_t second = start(words);
  int status = 0;
  ::waitpid(first, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  ::waitpid(second, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  expect_undisturbed_result();
  EXPECT_EQ(attempts().size(), 10u);
}

TEST_F(FaultyCampaign, InfrastructureFailuresAreTriedFinitely) {
  variables["FAKE_ONLY"] = "towed";
  variables["FAKE_END_AT"] = "5:50";
  variables["FAKE_END_ALWAYS"] = "1";
  const auto done = submit();
  EXPECT_EQ(done.code, 1) << done.out << done.err;
  EXPECT_EQ(run("towed").state, State::kFailed);
  EXPECT_EQ(run("slip_00").state, State::kCompleted);
  std::size_t tries = 0;
  for (const AttemptRow& attempt : attempts()) tries += attempt.run == run("towed").id ? 1 : 0;
  EXPECT_EQ(tries, 4u);
}

TEST_F(FaultyCampaign, AnEngineThatVanishesWithoutAWordIsTriedFinitely) {
  variables["FAKE_ONLY"] = "towed";
  variables["FAKE_NO_OUTCOME"] = "1";
  variables["FAKE_END_AT"] = "5:50";
  variables["FAKE_END_ALWAYS"] = "1";
  EXPECT_EQ(submit().code, 1);
  EXPECT_EQ(run("towed").state, State::kFailed);
  EXPECT_NE(run("towed").reason.find("4 attempts in a row without progress"), std::string::npos);
}

TEST_F(FaultyCampaign, ASolutionThatBrokeDownIsHeldAtOnce) {
  variables["FAKE_ONLY"] = "towed";
  variables["FAKE_END_AT"] = "155:30";
  EXPECT_EQ(submit().code, 1);
  EXPECT_EQ(run("towed").state, State::kHeld);
  EXPECT_EQ(run("towed").step, 140);  // the last good checkpoint, every 20 steps
  variables.clear();
  variables["GROUSER_ENGINE"] = FAKE_ENGINE;
  EXPECT_EQ(grouser({"resume", "towed"}).code, 0);
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
}

TEST_F(FaultyCampaign, AnEngineThatPausesWithoutAStepDoesNotGoOnForEver) {
  variables["FAKE_ONLY"] = "towed";
  variables["FAKE_STUCK"] = "1";
  EXPECT_EQ(submit().code, 1);
  EXPECT_EQ(run("towed").state, State::kFailed);
}

TEST_F(FaultyCampaign, ABedThatFailsHoldsItsRunsBackAndSaysSo) {
  variables["FAKE_ONLY"] = "beds/";
  variables["FAKE_END_AT"] = "5:30";
  EXPECT_EQ(submit().code, 1);
  EXPECT_EQ(run("towed").state, State::kPlanned);
}

}  // namespace
}  // namespace grouser
