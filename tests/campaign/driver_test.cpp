// SPDX-License-Identifier: BSD-3-Clause
// The manager against a scheduler in memory and a clock that tests turn.
#include <array>
#include <random>

#include "driving.hpp"

namespace grouser {
namespace {

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

// scancel sends TERM too, and the engine cannot tell who sent it.
TEST_F(Driving, APersonsScancelHoldsTheRunAndKeepsItsCheckpoint) {
  tick();
  end_engine("bed", EngineCode::kPaused, 30, 0.03, true);
  scheduler_.jobs.begin()->second.end = JobEnd::kCancelled;
  tick();
  EXPECT_EQ(run("bed").state, State::kHeld);
  EXPECT_EQ(run("bed").step, 30);
  EXPECT_EQ(store_->attempts().back().state, State::kChunkDone);
}

TEST_F(Driving, ASignalOfTheBatchSystemGoesOnByItself) {
  tick();
  end_engine("bed", EngineCode::kPaused, 30, 0.03, true);
  scheduler_.jobs.begin()->second.end = JobEnd::kTimeout;
  tick();
  EXPECT_EQ(run("bed").state, State::kQueued);
  EXPECT_EQ(store_->attempts().back().start_step, 30);
}

TEST_F(Driving, TheEngineIsToldToStartOrGoOnAndHowLongItMayTake) {
  tick();
  const std::string script = read_file(scheduler_.requests.front().script).value();
  EXPECT_NE(script.find("'--restart' 'auto'"), std::string::npos) << script;
  EXPECT_NE(script.find("'--max-seconds' '3420'"), std::string::npos) << script;
}

TEST_F(Driving, AnotherLookIsNeededWhileAnEndIsOpenOrARetryWaits) {
  const auto needed = [&] {
    return needs_another_look(store_->runs(), store_->active_attempts(), clock_.now());
  };
  tick();
  tick();
  EXPECT_FALSE(needed());
  scheduler_.jobs.begin()->second.phase = JobPhase::kEnded;
  scheduler_.jobs.begin()->second.end = JobEnd::kNodeFailed;
  tick();
  EXPECT_TRUE(needed());  // seen to have ended once
  tick();
  EXPECT_TRUE(needed());  // waits for its retry
  tick(60.0);
  EXPECT_FALSE(needed());
}

TEST_F(Driving, WhatIsMeasuredPlansTheNextJob) {
  launch(small_campaign(kTwoSlips,
                        "campaign: small\nscheduler: slurm\nresources: {walltime: 8h}\n"
                        "planner: {checkpoints: true, walltime: true}\n"));
  tick();
  const std::string first = read_file(scheduler_.requests.back().script).value();
  EXPECT_EQ(first.find("--checkpoint-seconds"), std::string::npos);
  const RunRow bed = run("bed");
  Outcome outcome;
  outcome.token = store_->attempts(bed.id).back().token;
  outcome.code = EngineCode::kPaused;
  outcome.step = outcome.steps_done = 1000;
  outcome.time = 1.0;
  outcome.end_time = 2.0;
  outcome.checkpoint = "c.h5";
  outcome.compute_seconds = 600.0;
  outcome.slowest_checkpoint_seconds = 20.0;
  write_atomic(root_ / bed.directory / run_files::outcome(outcome.token), to_json(outcome));
  scheduler_.jobs.begin()->second.phase = JobPhase::kEnded;
  tick();
  // The other half takes 600 s again: 1.5 x 600 + 120 + 2 x 20 s are two quarters of an hour.
  const std::string second = read_file(scheduler_.requests.back().script).value();
  EXPECT_NE(second.find("#SBATCH --time=0-00:30:00"), std::string::npos) << second;
  EXPECT_NE(second.find("'--checkpoint-seconds'"), std::string::npos) << second;
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
