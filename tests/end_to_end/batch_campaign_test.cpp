// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "base/atomic_file.hpp"
#include "campaign_run.hpp"

namespace grouser {
namespace {

struct Batch {
  const char* name;
  const char* submit;  ///< its commands
  const char* query;
};

void PrintTo(const Batch& batch, std::ostream* out) { *out << batch.name; }

std::string name_of(const ::testing::TestParamInfo<Batch>& kind) { return kind.param.name; }

class BatchCampaign : public CampaignRun, public ::testing::WithParamInterface<Batch> {
 protected:
  BatchCampaign() {
    // `env` is a launcher that launches one rank of anything.
    write_campaign("scheduler: " + std::string(GetParam().name) +
                   "\nresources: {walltime: 1h, launcher: env, concurrent: 3}\n"
                   "chunks: {count: 2}\n");
    const auto fakes = std::filesystem::path(FAKES_DIRECTORY) / GetParam().name;
    variables["PATH"] = fakes.string() + ":" + std::getenv("PATH");
    variables["FAKE_BATCH_DIR"] = batch().string();
    variables["FAKE_STEP_MICROSECONDS"] = "500";
    std::filesystem::create_directories(batch());
  }
  ~BatchCampaign() override {
    std::error_code error;
    for (const auto& job : std::filesystem::directory_iterator(batch() / "jobs", error))
      if (const auto pid = read_file(job.path() / "pid"))
        run_command({"pkill", "-KILL", "--session", pid->substr(0, pid->find('\n'))}, 10.0);
  }
  std::filesystem::path batch() const { return directory_.path() / "batch"; }

  // What the next calls of a command do: one word each.
  void misbehave(const std::string& command, const std::vector<std::string>& modes) {
    std::string text;
    for (const std::string& mode : modes) text += mode + "\n";
    write_atomic(batch() / (command + ".modes"), text);
  }
  std::size_t calls(const std::string& command) const {
    const auto text = read_file(batch() / (command + ".calls"));
    return text ? static_cast<std::size_t>(std::count(text->begin(), text->end(), '\n')) : 0;
  }
  std::size_t jobs() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& job : std::filesystem::directory_iterator(batch() / "jobs"))
      ++count;
    return count;
  }
};

constexpr std::size_t kJobs = 1 + 3 * 2;

TEST_P(BatchCampaign, RunsToItsEnd) {
  const auto done = submit();
  EXPECT_EQ(done.code, 0) << done.out << done.err;
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
}

TEST_P(BatchCampaign, SubmitLeavesAndTicksCarryOn) {
  EXPECT_EQ(grouser({"submit", "campaign.yaml"}).code, 0);
  EXPECT_EQ(attempts().size(), 1u);
  ASSERT_TRUE(wait_for([&] {
    grouser({"tick", "--grace", "0.5"});
    const auto all = runs();
    return std::all_of(all.begin(), all.end(),
                       [](const RunRow& one) { return one.state == State::kCompleted; });
  }));
  expect_undisturbed_result();
}

TEST_P(BatchCampaign, StatusReadsTheFilesAndAsksTheSchedulerOnlyWhenTold) {
  EXPECT_EQ(grouser({"submit", "campaign.yaml"}).code, 0);
  const auto exit =
      root() / runs().front().directory / "attempts" / (attempts().front().token + ".exit");
  ASSERT_TRUE(wait_for([&] { return std::filesystem::exists(exit); }));
  const auto seen = grouser({"status", "--check"});
  EXPECT_EQ(seen.code, 0);
  EXPECT_NE(seen.out.find("1 COMPLETED"), std::string::npos) << seen.out;
  EXPECT_EQ(calls(GetParam().query), 0u);
  EXPECT_EQ(grouser({"status", "--refresh"}).code, 0);
  EXPECT_EQ(calls(GetParam().query), 1u);
}

TEST_P(BatchCampaign, StatusSaysThatAJobWasKilled) {
  variables["FAKE_KILL_AT"] = "60";
  EXPECT_EQ(grouser({"submit", "campaign.yaml"}).code, 0);
  ASSERT_TRUE(wait_for([&] { return grouser({"status", "--check"}).code == 1; }));
  const auto seen = grouser({"status"});
  EXPECT_NE(seen.out.find("the job has ended and left no outcome so far"), std::string::npos)
      << seen.out;
  EXPECT_EQ(calls(GetParam().query), 0u);
}

TEST_P(BatchCampaign, WithoutTheSchedulersCommandsEveryVerbSaysWhatToDo) {
  const std::string path = variables["PATH"];
  variables["PATH"] = directory_.path().string();
  const auto refused = grouser({"submit", "campaign.yaml"});
  EXPECT_EQ(refused.code, 1) << refused.err;
  EXPECT_EQ(refused.out.find("by themselves"), std::string::npos) << refused.out;
  for (const std::string& part :
       {std::string("1 run waits for a person:"),
        runs().front().label + "  HELD  refused: ", "grouser resume --all -C " + root().string()})
    EXPECT_NE(refused.out.find(part), std::string::npos) << part << "\n" << refused.out;
  EXPECT_EQ(grouser({"tick"}).code, 1);
  EXPECT_EQ(grouser({"tick", "--wait"}).code, 1);
  EXPECT_EQ(grouser({"resume", "--all"}).code, 1);
  EXPECT_EQ(grouser({"status", "--check"}).code, 1);
  variables["PATH"] = path;
  EXPECT_EQ(grouser({"resume", "--all"}).code, 0);
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
}

TEST_P(BatchCampaign, AManagerThatDiedBeforeNotingTheJobFindsItAgain) {
  variables["GROUSER_FAULT"] = "after_submit";
  for (int life = 0; life < 3; ++life) EXPECT_EQ(submit().code, 137);
  variables.erase("GROUSER_FAULT");
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
}

TEST_P(BatchCampaign, ASubmissionThatTimedOutButCameThroughIsAdopted) {
  misbehave(GetParam().submit, {"timeout", "timeout", "", "timeout"});
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
}

TEST_P(BatchCampaign, ASubmissionThatWasLostIsMadeAgain) {
  misbehave(GetParam().submit, {"lost", "", "lost"});
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
  EXPECT_EQ(calls(GetParam().submit), kJobs + 2);
}

TEST_P(BatchCampaign, FailedAndGarbledAnswersChangeNothing) {
  misbehave(GetParam().query,
            {"fail", "garbled", "fail", "", "garbled", "garbled", "fail", "", "", "garbled"});
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
  for (const AttemptRow& attempt : attempts()) EXPECT_NE(attempt.state, State::kFailed);
}

TEST_P(BatchCampaign, AJobKilledWithItsNodeIsTriedAgain) {
  variables["FAKE_KILL_AT"] = "60,200";
  EXPECT_EQ(grouser({"submit", "campaign.yaml"}).code, 0);
  // A minute passes before the retry itself: the state is what counts here.
  ASSERT_TRUE(wait_for([&] {
    grouser({"tick", "--grace", "0.5"});
    return runs().front().state == State::kReady;
  }));
  EXPECT_EQ(runs().front().failures, 1);
  EXPECT_EQ(runs().front().step, 60);
  EXPECT_NE(runs().front().reason.find("killed by signal 9"), std::string::npos);
}

TEST_P(BatchCampaign, StopAndCancelReachTheJobs) {
  variables["FAKE_STEP_MICROSECONDS"] = "20000";
  EXPECT_EQ(grouser({"submit", "campaign.yaml"}).code, 0);
  const std::string bed = runs().front().label;
  const auto progress = root() / runs().front().directory / "progress.json";
  ASSERT_TRUE(wait_for([&] { return std::filesystem::exists(progress); }));
  EXPECT_EQ(grouser({"stop", bed, "--every", "0.1"}).code, 0);
  ASSERT_TRUE(wait_for([&] {
    grouser({"tick"});
    return run(bed).state == State::kHeld;
  }));
  EXPECT_EQ(grouser({"resume", bed}).code, 0);
  std::filesystem::remove(progress);
  ASSERT_TRUE(wait_for([&] { return std::filesystem::exists(progress); }));
  EXPECT_EQ(grouser({"cancel", bed, "--yes", "--every", "0.1"}).code, 0);
  ASSERT_TRUE(wait_for([&] {
    grouser({"tick"});
    return run(bed).state == State::kCancelled;
  }));
}

INSTANTIATE_TEST_SUITE_P(Kinds, BatchCampaign,
                         ::testing::Values(Batch{"slurm", "sbatch", "squeue"},
                                           Batch{"pbs", "qsub", "qstat"}),
                         name_of);

class SlurmCampaign : public BatchCampaign {};

TEST_P(SlurmCampaign, AccountingThatFailsOrForgetsIsSurvived) {
  misbehave("sacct", {"fail", "garbled", "empty", "fail", "", "garbled"});
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
}

TEST_P(SlurmCampaign, ASubmissionThatPrintedNonsenseIsFoundByItsName) {
  misbehave("sbatch", {"garbled", "silent"});
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
}

TEST_P(SlurmCampaign, ARefusalIsHeldWithSlurmsWords) {
  misbehave("sbatch", {"refuse"});
  EXPECT_EQ(submit().code, 1);
  EXPECT_NE(runs().front().reason.find("Invalid account"), std::string::npos);
}

TEST_P(SlurmCampaign, APersonsOwnScancelIsRespected) {
  variables["FAKE_STEP_MICROSECONDS"] = "20000";
  EXPECT_EQ(grouser({"submit", "campaign.yaml"}).code, 0);
  const auto progress = root() / runs().front().directory / "progress.json";
  ASSERT_TRUE(wait_for([&] { return std::filesystem::exists(progress); }));
  std::vector<std::string> words{"env"};
  for (const auto& [name, value] : variables) words.push_back(name + "=" + value);
  words.insert(words.end(), {"scancel", attempts().front().job});
  ASSERT_EQ(run_command(words, 10.0).code, 0);
  ASSERT_TRUE(wait_for([&] {
    grouser({"tick"});
    return runs().front().state == State::kHeld;
  }));
  EXPECT_NE(runs().front().reason.find("cancelled"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SlurmCampaign,
                         ::testing::Values(Batch{"slurm", "sbatch", "squeue"}), name_of);

class PbsCampaign : public BatchCampaign {};

TEST_P(PbsCampaign, AServerWithoutHistoryIsEnough) {
  write_atomic(batch() / "no_history", "");
  EXPECT_EQ(submit().code, 0);
  expect_undisturbed_result();
  EXPECT_EQ(jobs(), kJobs);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PbsCampaign, ::testing::Values(Batch{"pbs", "qsub", "qstat"}),
                         name_of);

}  // namespace
}  // namespace grouser
