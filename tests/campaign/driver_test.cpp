// SPDX-License-Identifier: BSD-3-Clause
// The manager against a scheduler in memory and a clock that tests turn.
#include "campaign/drive/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>

#include "base/atomic_file.hpp"
#include "campaign/drive/launch.hpp"
#include "campaign/drive/wishes.hpp"
#include "small_campaign.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

const LeaseHolder kMe{"here", "boot", 1, 2, 0};

class TestClock : public Clock {
 public:
  double now() override { return time; }
  void sleep(double seconds) override { time += seconds; }
  double time = 1e9;
};

class TestScheduler : public Scheduler {
 public:
  SubmitAnswer submit(const JobRequest& request) override {
    requests.push_back(request);
    if (next_answer.kind != SubmitAnswer::Kind::kUnclear || takes_unclear)
      jobs[request.name] = {request.name,
                            "j" + std::to_string(requests.size()),
                            JobPhase::kRunning,
                            JobEnd::kNone,
                            -1,
                            ""};
    SubmitAnswer answer = next_answer;
    if (answer.kind == SubmitAnswer::Kind::kAccepted) answer.job = jobs[request.name].id;
    if (answer.kind == SubmitAnswer::Kind::kBusy || answer.kind == SubmitAnswer::Kind::kRefused)
      jobs.erase(request.name);
    next_answer = {SubmitAnswer::Kind::kAccepted, "", ""};
    return answer;
  }
  QueryAnswer query(const std::vector<JobKey>& keys) override {
    QueryAnswer answer;
    answer.is_complete = can_be_asked;
    answer.why_not = can_be_asked ? "" : "down";
    if (!can_be_asked) return answer;
    for (const JobKey& key : keys)
      if (jobs.count(key.name) > 0) answer.jobs.push_back(jobs[key.name]);
    return answer;
  }
  std::string cancel(const JobKey& key, CancelMode mode) override {
    cancelled.emplace_back(key.name, mode);
    return "";
  }

  std::vector<JobRequest> requests;
  std::map<std::string, JobStatus> jobs;
  std::vector<std::pair<std::string, CancelMode>> cancelled;
  SubmitAnswer next_answer{SubmitAnswer::Kind::kAccepted, "", ""};
  bool takes_unclear = true;
  bool can_be_asked = true;
};

class Driving : public ::testing::Test {
 protected:
  explicit Driving(const std::string& head =
                       "campaign: small\nscheduler: slurm\n"
                       "resources: {walltime: 1h}\n") {
    write_atomic(directory_.path() / "c.yaml", small_campaign(kTwoSlips, head));
    root_ = directory_.path() / "root";
    std::filesystem::create_directories(root_);
    store_.emplace(Store::open(root_ / Store::kFileName));
    store_->take_lease(kMe, [](const LeaseHolder&) { return true; });
    launch_plan(plan_campaign(directory_.path() / "c.yaml", ""), directory_.path() / "c.yaml",
                "/bin/true", root_, clock_.now(), *store_);
  }

  // Each tick is a manager process of its own.
  TickReport tick(double later = 40.0) {
    clock_.time += later;
    return Driver(root_, *store_, scheduler_, clock_).tick();
  }

  RunRow run(const std::string& start) const {
    for (const RunRow& one : store_->runs())
      if (one.label.rfind(start, 0) == 0) return one;
    throw std::runtime_error("no run " + start);
  }

  // What an engine that ended leaves behind.
  void end_engine(const std::string& label, EngineCode code, std::int64_t step, double time) {
    const RunRow of = run(label);
    const AttemptRow attempt = store_->attempts(of.id).back();
    Outcome outcome;
    outcome.token = attempt.token;
    outcome.code = code;
    outcome.step = step;
    outcome.time = time;
    outcome.checkpoint = "c.h5";
    write_atomic(root_ / of.directory / run_files::outcome(attempt.token), to_json(outcome));
    JobStatus& job = scheduler_.jobs[job_name(attempt.token)];
    job.phase = JobPhase::kEnded;
    job.end = code == EngineCode::kFinished ? JobEnd::kDone : JobEnd::kFailed;
    job.exit_code = static_cast<int>(code);
  }

  void settle_bed() {
    tick();
    end_engine("bed", EngineCode::kFinished, 50, 0.05);
    tick();
  }

  TemporaryDirectory directory_;
  std::filesystem::path root_;
  TestClock clock_;
  TestScheduler scheduler_;
  std::optional<Store> store_;
};

TEST_F(Driving, RunsWaitForTheirBed) {
  tick();
  EXPECT_EQ(scheduler_.requests.size(), 1u);
  EXPECT_EQ(run("towed").state, State::kPlanned);
  tick();
  EXPECT_EQ(scheduler_.requests.size(), 1u);
  end_engine("bed", EngineCode::kFinished, 50, 0.05);
  tick();
  EXPECT_EQ(run("bed").state, State::kCompleted);
  EXPECT_EQ(scheduler_.requests.size(), 3u);
  EXPECT_EQ(run("towed").state, State::kQueued);
}

TEST_F(Driving, TheFenceNamesTheAttemptThatOwnsTheRun) {
  tick();
  const RunRow bed = run("bed");
  EXPECT_EQ(read_file(root_ / bed.directory / run_files::kFence),
            store_->attempts(bed.id).back().token);
}

TEST_F(Driving, ATickWithNothingNewChangesNothing) {
  tick();
  tick();
  const auto before = store_->attempts();
  for (int i = 0; i < 5; ++i) {
    const TickReport report = tick();
    EXPECT_EQ(report.submitted + report.ended, 0);
  }
  EXPECT_EQ(store_->attempts().size(), before.size());
}

TEST_F(Driving, AnUnclearAnswerIsResolvedByLookingForTheToken) {
  scheduler_.next_answer = {SubmitAnswer::Kind::kUnclear, "", "Socket timed out"};
  tick();
  EXPECT_EQ(run("bed").state, State::kSubmitting);
  tick();
  EXPECT_EQ(run("bed").state, State::kRunning);
  EXPECT_EQ(store_->attempts().front().job, "j1");
  EXPECT_EQ(scheduler_.requests.size(), 1u);
}

TEST_F(Driving, AJobThatNeverArrivedIsSubmittedAgainUnderANewToken) {
  scheduler_.next_answer = {SubmitAnswer::Kind::kUnclear, "", "Socket timed out"};
  scheduler_.takes_unclear = false;
  tick();
  tick(40.0);
  EXPECT_EQ(scheduler_.requests.size(), 1u);  // within the grace
  tick(100.0);
  ASSERT_EQ(scheduler_.requests.size(), 2u);
  EXPECT_NE(scheduler_.requests[0].name, scheduler_.requests[1].name);
  EXPECT_EQ(run("bed").failures, 0);
}

TEST_F(Driving, ASchedulerThatIsDownForHoursChangesNothing) {
  settle_bed();
  scheduler_.can_be_asked = false;
  for (int hour = 0; hour < 48; ++hour) tick(3600.0);
  EXPECT_EQ(run("towed").state, State::kUnknown);
  EXPECT_EQ(scheduler_.requests.size(), 3u);
  scheduler_.can_be_asked = true;
  tick();
  EXPECT_EQ(run("towed").state, State::kRunning);
}

TEST_F(Driving, ABusySchedulerIsAskedAgainLater) {
  scheduler_.next_answer = {SubmitAnswer::Kind::kBusy, "", "AssocMaxSubmitJobLimit"};
  tick();
  EXPECT_EQ(run("bed").state, State::kReady);
  EXPECT_EQ(run("bed").reason, "AssocMaxSubmitJobLimit");
  tick(10.0);
  EXPECT_EQ(scheduler_.requests.size(), 1u);
  tick(60.0);
  EXPECT_EQ(scheduler_.requests.size(), 2u);
}

TEST_F(Driving, ARefusalHoldsTheRunWithTheSchedulersWords) {
  scheduler_.next_answer = {SubmitAnswer::Kind::kRefused, "", "Invalid account"};
  tick();
  EXPECT_EQ(run("bed").state, State::kHeld);
  EXPECT_EQ(run("bed").reason, "refused: Invalid account");
  EXPECT_TRUE(is_at_rest(store_->runs()));
  EXPECT_TRUE(make_wish(*store_, run("bed"), Wish::kResume, clock_.now()));
  tick();
  EXPECT_EQ(run("bed").state, State::kQueued);
}

TEST_F(Driving, AnEngineThatBrokeDownIsNotTriedAgain) {
  tick();
  end_engine("bed", EngineCode::kBrokeDown, 10, 0.01);
  tick();
  EXPECT_EQ(run("bed").state, State::kHeld);
  for (int i = 0; i < 10; ++i) tick(3600.0);
  EXPECT_EQ(scheduler_.requests.size(), 1u);
}

TEST_F(Driving, QuickFailuresAreSpacedOutAndThenGivenUp) {
  tick();
  std::vector<double> waits;
  for (int failure = 0; failure < 4; ++failure) {
    end_engine("bed", EngineCode::kParallelFailed, 0, 0.0);
    tick(1.0);
    waits.push_back(run("bed").not_before - clock_.now());
    tick(4000.0);
  }
  EXPECT_EQ(run("bed").state, State::kFailed);
  EXPECT_EQ(scheduler_.requests.size(), 4u);
  EXPECT_DOUBLE_EQ(waits[0], 60.0);
  EXPECT_DOUBLE_EQ(waits[1], 120.0);
  EXPECT_DOUBLE_EQ(waits[2], 240.0);
}

TEST_F(Driving, AStopLeavesTheStopFileAndHoldsTheRun) {
  settle_bed();
  tick();
  ASSERT_TRUE(make_wish(*store_, run("towed"), Wish::kStop, clock_.now()));
  tick();
  const auto stop = root_ / run("towed").directory / run_files::kStop;
  EXPECT_EQ(read_file(stop), "user\n");
  EXPECT_TRUE(scheduler_.cancelled.empty());
  end_engine("towed", EngineCode::kStopped, 20, 0.02);
  tick();
  EXPECT_EQ(run("towed").state, State::kHeld);
  EXPECT_EQ(run("towed").reason, "stopped on request");
  ASSERT_TRUE(make_wish(*store_, run("towed"), Wish::kResume, clock_.now()));
  tick();
  EXPECT_FALSE(std::filesystem::exists(stop));
  EXPECT_EQ(run("towed").state, State::kQueued);
}

TEST_F(Driving, ACancelIsPoliteFirst) {
  tick();
  ASSERT_TRUE(make_wish(*store_, run("bed"), Wish::kCancel, clock_.now()));
  tick(1.0);
  tick(20.0);
  ASSERT_GE(scheduler_.cancelled.size(), 2u);
  EXPECT_EQ(scheduler_.cancelled.front().second, CancelMode::kTerminate);
  EXPECT_EQ(scheduler_.cancelled.back().second, CancelMode::kKill);
  scheduler_.jobs.begin()->second.phase = JobPhase::kEnded;
  scheduler_.jobs.begin()->second.end = JobEnd::kCancelled;
  tick();
  tick();
  EXPECT_EQ(run("bed").state, State::kCancelled);
}

TEST_F(Driving, LaunchingAgainChangesNothing) {
  tick();
  const auto before = store_->runs();
  launch_plan(plan_campaign(directory_.path() / "c.yaml", ""), directory_.path() / "c.yaml",
              "/bin/true", root_, clock_.now(), *store_);
  EXPECT_EQ(store_->runs().size(), before.size());
  EXPECT_EQ(run("bed").state, State::kQueued);
}

TEST_F(Driving, AChangedCaseBecomesANewRunAndTheOldOneStays) {
  std::string yaml = small_campaign(kTwoSlips,
                                    "campaign: small\nscheduler: slurm\n"
                                    "resources: {walltime: 2h}\n");
  yaml.replace(yaml.find("slip: 20 %"), 10, "slip: 25 %");
  write_atomic(directory_.path() / "c.yaml", yaml);
  const Plan plan = plan_campaign(directory_.path() / "c.yaml", "");
  const auto report = compare_plan(plan, directory_.path() / "c.yaml", root_, *store_);
  EXPECT_EQ(report.added, std::vector<std::string>{"slip_20"});
  EXPECT_EQ(report.gone, std::vector<std::string>{"slip_20"});
  EXPECT_TRUE(report.settings_changed);
  launch_plan(plan, directory_.path() / "c.yaml", "/bin/true", root_, clock_.now(), *store_);
  EXPECT_EQ(store_->runs().size(), 4u);
}

// Whatever answers a scheduler gives and whatever engines do, a run never has two live jobs.
TEST_F(Driving, NeverHasTwoLiveJobsOfARun) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  const auto pick = [&](int count) {
    return static_cast<int>(random() % static_cast<unsigned>(count));
  };
  for (int i = 0; i < 400; ++i) {
    scheduler_.can_be_asked = pick(4) != 0;
    scheduler_.takes_unclear = pick(2) == 0;
    const std::array<SubmitAnswer::Kind, 4> kinds{
        SubmitAnswer::Kind::kAccepted, SubmitAnswer::Kind::kAccepted, SubmitAnswer::Kind::kUnclear,
        SubmitAnswer::Kind::kBusy};
    scheduler_.next_answer = {kinds[static_cast<std::size_t>(pick(4))], "", "told so"};
    for (auto& [name, job] : scheduler_.jobs)
      if (job.phase == JobPhase::kRunning && pick(10) == 0) {
        job.phase = JobPhase::kEnded;
        job.end = pick(2) == 0 ? JobEnd::kNodeFailed : JobEnd::kPreempted;
      }
    tick(pick(2) == 0 ? 1.0 : 200.0);
    std::map<std::string, int> live;
    for (const auto& request : scheduler_.requests) {
      const auto job = scheduler_.jobs.find(request.name);
      if (job != scheduler_.jobs.end() && job->second.phase != JobPhase::kEnded)
        ++live[request.work_directory.string()];
    }
    for (const auto& [directory, count] : live)
      ASSERT_LE(count, 1) << directory << " at turn " << i << ", seed " << seed;
    for (const RunRow& one : store_->runs())
      if (one.state == State::kFailed) make_wish(*store_, one, Wish::kResume, clock_.now());
  }
}

}  // namespace
}  // namespace grouser
