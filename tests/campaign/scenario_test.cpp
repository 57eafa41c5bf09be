// SPDX-License-Identifier: BSD-3-Clause
// What a campaign must survive, one test or more for each scenario of docs/failures.md. S01, S09,
// S10, S14 and S19 need a real engine or a file system: see the table there.
#include <sys/wait.h>
#include <unistd.h>

#include "driving.hpp"
#include "schedulers/command.hpp"

namespace grouser {
namespace {

class Scenarios : public Driving {
 protected:
  AttemptRow newest(const std::string& label) const {
    return store_->attempts(run(label).id).back();
  }
  JobStatus& job_of(const std::string& label) {
    return scheduler_.jobs[job_name(newest(label).token)];
  }
  std::filesystem::path folder(const std::string& label) const {
    return root_ / run(label).directory;
  }
  std::string script(const std::string& label) const {
    return read_file(folder(label) / attempt_files::script(newest(label).token)).value();
  }
  void end_job(const std::string& label, JobEnd end, const std::string& detail = "") {
    JobStatus& job = job_of(label);
    job.phase = JobPhase::kEnded;
    job.end = end;
    job.detail = detail;
  }
  void put_record(const std::string& label, const std::string& host) {
    const std::string token = newest(label).token;
    write_atomic(
        folder(label) / attempt_files::started(token),
        R"({"token": ")" + token + R"(", "job": "1", "host": ")" + host + R"(", "code": -1})");
  }
  void put_checkpoint(const std::string& label, std::int64_t step) {
    CheckpointManifest manifest;
    manifest.file = "step" + run_files::step_digits(step) + ".h5";
    manifest.step = step;
    manifest.time = 1e-3 * static_cast<double>(step);
    manifest.state_hash = "h" + std::to_string(step);
    const auto directory = folder(label) / run_files::kCheckpoints;
    write_atomic(directory / manifest.file, "");
    write_atomic((directory / manifest.file).replace_extension(".json"), to_json(manifest));
  }
  void put_progress(const std::string& label, std::int64_t step) {
    Progress progress;
    progress.token = newest(label).token;
    progress.step = step;
    write_atomic(folder(label) / run_files::kProgress, to_json(progress));
  }
  std::size_t live_jobs() const {
    std::size_t count = 0;
    for (const auto& [name, job] : scheduler_.jobs) count += job.phase == JobPhase::kEnded ? 0 : 1;
    return count;
  }
  // Two ticks, as batch systems need to believe in an end without an outcome.
  void settle_end(double later = 40.0) {
    tick(later);
    tick(1.0);
  }
};

TEST_F(Scenarios, S02AManagerKilledBetweenSbatchAndItsCommitFindsTheJob) {
  scheduler_.next_answer = {SubmitAnswer::Kind::kUnclear, "", "killed here"};
  tick();
  EXPECT_EQ(newest("bed").job, "");
  tick();
  EXPECT_EQ(newest("bed").job, "j1");
  EXPECT_EQ(scheduler_.requests.size(), 1u);
}

TEST_F(Scenarios, S03AnSbatchThatTimedOutIsNotRepeatedWhileItsJobMayExist) {
  scheduler_.next_answer = {SubmitAnswer::Kind::kUnclear, "", "Socket timed out"};
  scheduler_.can_be_asked = false;
  tick();
  for (int i = 0; i < 50; ++i) tick(600.0);
  EXPECT_EQ(scheduler_.requests.size(), 1u);
  EXPECT_EQ(run("bed").state, State::kSubmitting);
}

TEST_F(Scenarios, S04TheSameChunkSubmittedTwiceIsRefusedByTheDatabase) {
  tick();
  const RunRow bed = run("bed");
  AttemptRow second = newest("bed");
  second.token = "another";
  EXPECT_THROW(store_->add_attempt(second, bed, store_->chunks(bed.id).front()), StorageError);
}

TEST_F(Scenarios, S05ANodeThatFailsIsTriedElsewhereFromTheNewestCheckpoint) {
  tick();
  put_record("bed", "node7");
  put_checkpoint("bed", 40);
  tick();
  end_job("bed", JobEnd::kNodeFailed, "NODE_FAIL");
  settle_end();
  EXPECT_EQ(run("bed").state, State::kReady);
  tick(60.0);
  EXPECT_EQ(newest("bed").start_step, 40);
  EXPECT_EQ(run("bed").state, State::kQueued);
}

TEST_F(Scenarios, S06ANodeOnWhichJobsKeepFailingIsLeftOut) {
  for (int failure = 0; failure < 2; ++failure) {
    tick(700.0);
    put_record("bed", "node7");
    tick();
    end_job("bed", JobEnd::kNodeFailed);
    settle_end(400.0);
    EXPECT_EQ(script("bed").find("--exclude"), std::string::npos);
  }
  tick(700.0);
  EXPECT_NE(script("bed").find("#SBATCH --exclude=node7\n"), std::string::npos) << script("bed");
}

TEST_F(Scenarios, S06AfterThreeQuickFailuresNothingIsSubmittedForTenMinutes) {
  settle_bed();
  tick();
  for (const char* label : {"towed", "slip_20"}) end_job(label, JobEnd::kNodeFailed);
  settle_end(1.0);
  tick(100.0);
  const auto before = scheduler_.requests.size();
  end_job("towed", JobEnd::kNodeFailed);
  end_job("slip_20", JobEnd::kNodeFailed);
  settle_end(1.0);
  tick(300.0);
  EXPECT_EQ(scheduler_.requests.size(), before);
  tick(400.0);
  EXPECT_GT(scheduler_.requests.size(), before);
}

TEST_F(Scenarios, S07ASchedulerThatCannotBeAskedEndsNothing) {
  settle_bed();
  scheduler_.can_be_asked = false;
  for (int hour = 0; hour < 48; ++hour) tick(3600.0);
  EXPECT_EQ(run("towed").state, State::kUnknown);
  EXPECT_NE(run("towed").reason.find("cannot ask the scheduler"), std::string::npos);
  EXPECT_EQ(scheduler_.requests.size(), 3u);
}

TEST_F(Scenarios, S08OfASweepPartlyFailedOnlyTheFailedPartIsDoneAgain) {
  settle_bed();
  tick();
  end_engine("towed", EngineCode::kFinished, 200, 0.2);
  end_job("slip_20", JobEnd::kNodeFailed);
  settle_end();
  tick(60.0);
  EXPECT_EQ(run("towed").state, State::kCompleted);
  EXPECT_EQ(store_->attempts(run("towed").id).size(), 1u);
  EXPECT_EQ(store_->attempts(run("slip_20").id).size(), 2u);
}

class Arrayed : public Scenarios {
 protected:
  Arrayed() {
    launch(small_campaign(kTwoSlips,
                          "campaign: small\nscheduler: slurm\nresources: {walltime: "
                          "1h, array: true, concurrent: 2}\n"));
    settle_bed();
  }
};

TEST_F(Arrayed, S08OfAnArrayOnlyTheFailedTasksAreDoneAgain) {
  ASSERT_EQ(scheduler_.requests.size(), 2u);
  EXPECT_NE(read_file(scheduler_.requests.back().script)->find("#SBATCH --array=0-1%2\n"),
            std::string::npos);
  EXPECT_EQ(newest("towed").job, "j2_0");
  tick();
  EXPECT_EQ(run("slip_20").state, State::kRunning);
  end_engine("towed", EngineCode::kFinished, 200, 0.2);
  end_job("slip_20", JobEnd::kNodeFailed);
  settle_end();
  tick(60.0);
  EXPECT_EQ(run("towed").state, State::kCompleted);
  EXPECT_EQ(scheduler_.requests.size(), 3u);
  EXPECT_EQ(newest("slip_20").job, "j3");  // alone, so no array
}

TEST_F(Arrayed, S08TasksThatVanishWhilePendingAreSubmittedAgain) {
  scheduler_.jobs.erase(job_name(newest("slip_20").token));
  tick(100.0);
  tick(100.0);
  EXPECT_EQ(run("towed").state, State::kRunning);
  EXPECT_EQ(newest("slip_20").number, 1);
  EXPECT_EQ(run("slip_20").state, State::kReady);
}

TEST_F(Scenarios, S03AnArrayWhoseSbatchTimedOutIsFoundTaskByTask) {
  launch(small_campaign(kTwoSlips,
                        "campaign: small\nscheduler: slurm\nresources: {walltime: 1h, "
                        "array: true}\n"));
  tick();
  end_engine("bed", EngineCode::kFinished, 50, 0.05);
  scheduler_.next_answer = {SubmitAnswer::Kind::kUnclear, "", "Socket timed out"};
  tick();
  EXPECT_EQ(run("towed").state, State::kSubmitting);
  tick();
  EXPECT_EQ(newest("towed").job, "j2_0");
  EXPECT_EQ(newest("slip_20").job, "j2_1");
  EXPECT_EQ(scheduler_.requests.size(), 2u);
}

TEST_F(Scenarios, S09AFullDiskHoldsTheRunAndSaysSo) {
  tick();
  put_checkpoint("bed", 40);
  end_engine("bed", EngineCode::kStorageFailed, 55, 0.055);
  tick();
  EXPECT_EQ(run("bed").state, State::kHeld);
  EXPECT_EQ(run("bed").step, 40);  // the checkpoint before stands
  EXPECT_EQ(newest("bed").outcome_class, "RESOURCE");
}

TEST_F(Scenarios, S10AnAttemptLeavesABoundedNumberOfFiles) {
  settle_bed();
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder("bed")))
    files += entry.is_regular_file() ? 1 : 0;
  // case.yaml, fence, script, outcome; a job adds log, started, exit, the engine its own.
  EXPECT_LE(files, 4u);
  std::size_t in_root = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root_))
    in_root += entry.is_regular_file() ? 1 : 0;
  EXPECT_LE(in_root, 5u);  // database, its log and index, journal, campaign.yaml
}

TEST_F(Scenarios, S11AClockThatIsSetBackHoldsNothingUp) {
  tick();
  end_engine("bed", EngineCode::kParallelFailed, 0, 0.0);
  tick();
  EXPECT_EQ(run("bed").state, State::kReady);
  tick(-1e6);  // the delay before the retry now ends in eleven days
  EXPECT_EQ(run("bed").state, State::kQueued);
  make_wish(*store_, run("bed"), Wish::kCancel, clock_.now());
  tick();
  tick(-1e6);
  EXPECT_EQ(scheduler_.cancelled.back().second, CancelMode::kKill);
}

TEST_F(Scenarios, S11AClockThatIsSetBackMakesNoJobLookGone) {
  tick();
  scheduler_.jobs.clear();
  tick();
  tick(-1e6);
  EXPECT_EQ(run("bed").state, State::kUnknown);
  tick(100.0);
  EXPECT_EQ(run("bed").state, State::kReady);
}

TEST_F(Scenarios, S12ALockedDatabaseIsWaitedFor) {
  const auto file = root_ / Store::kFileName;
  const pid_t other = ::fork();
  if (other == 0) {
    ::execlp("sqlite3", "sqlite3", file.c_str(), "BEGIN IMMEDIATE", ".shell sleep 1", "COMMIT",
             nullptr);
    ::_exit(127);
  }
  const auto is_locked = [&] {
    return run_command({"sqlite3", file.string(), "BEGIN IMMEDIATE; ROLLBACK"}, 10.0).code != 0;
  };
  while (!is_locked()) {
  }
  tick();
  EXPECT_EQ(run("bed").state, State::kQueued);
  int status = 0;
  ::waitpid(other, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(Scenarios, S15ACheckpointThatKillsTheEngineTwiceIsSetAside) {
  tick();
  put_checkpoint("bed", 40);
  put_checkpoint("bed", 60);
  end_job("bed", JobEnd::kNodeFailed);
  settle_end();
  EXPECT_EQ(run("bed").step, 60);
  for (int failure = 0; failure < 2; ++failure) {
    tick(700.0);
    EXPECT_EQ(newest("bed").start_step, 60);
    put_record("bed", "node" + std::to_string(failure));
    tick(1.0);
    end_job("bed", JobEnd::kKilled);
    settle_end(1.0);
  }
  const TickReport report = tick(700.0);
  EXPECT_EQ(newest("bed").start_step, 40);
  EXPECT_EQ(run("bed").step, 40);
  EXPECT_TRUE(std::filesystem::exists(folder("bed") / "checkpoints" / "step000000000060.bad"));
  std::string said;
  for (const std::string& one : report.messages) said += one + "\n";
  EXPECT_NE(said.find("the engine died twice reading step000000000060.h5; it is set aside"),
            std::string::npos)
      << said;
}

TEST_F(Scenarios, S15TheOnlyCheckpointIsNeverSetAside) {
  tick();
  put_checkpoint("bed", 40);
  for (int failure = 0; failure < 3; ++failure) {
    put_record("bed", "node" + std::to_string(failure));
    tick(1.0);
    end_job("bed", JobEnd::kKilled);
    settle_end(1.0);
    tick(700.0);
  }
  EXPECT_TRUE(std::filesystem::exists(folder("bed") / "checkpoints" / "step000000000040.json"));
}

TEST_F(Scenarios, S16AChangedYamlChangesNothingThatWasSubmitted) {
  tick();
  const std::string before = read_file(folder("bed") / run_files::kCase).value();
  std::string text = small_campaign(kTwoSlips,
                                    "campaign: small\nscheduler: slurm\n"
                                    "resources: {walltime: 1h}\n");
  text.replace(text.find("load: 24 N"), 10, "load: 48 N");
  write_atomic(yaml(), text);
  tick();
  EXPECT_EQ(read_file(folder("bed") / run_files::kCase), before);
  const LaunchReport report = compare_plan(plan_campaign(yaml(), ""), yaml(), root_, *store_);
  EXPECT_TRUE(report.is_change());
  EXPECT_EQ(report.added.size(), 2u);
}

class OtherEngine : public Scenarios {
 protected:
  OtherEngine() {
    write_atomic(engine(), "first");
    launch_plan(plan_campaign(yaml(), ""), yaml(), engine(), root_, clock_.now(), *store_);
  }
  std::filesystem::path engine() const { return directory_.path() / "engine"; }
};

TEST_F(OtherEngine, S17AReplacedEngineIsNotUsedUntilSomebodySaysSo) {
  tick();
  put_checkpoint("bed", 40);
  end_engine("bed", EngineCode::kPaused, 40, 0.04, true);
  end_job("bed", JobEnd::kPreempted);
  write_atomic(engine(), "second");
  tick();
  EXPECT_EQ(run("bed").state, State::kHeld);
  EXPECT_NE(run("bed").reason.find("grouser resume --accept-engine"), std::string::npos)
      << run("bed").reason;
  make_wish(*store_, run("bed"), Wish::kResume, clock_.now());
  tick();
  EXPECT_EQ(run("bed").state, State::kHeld);
  make_wish(*store_, run("bed"), Wish::kResumeWithEngine, clock_.now());
  tick();
  EXPECT_EQ(run("bed").state, State::kQueued);
  tick();
  const Store reader = Store::open_read_only(root_ / Store::kFileName);
  EXPECT_EQ(reader.query("SELECT engine_changed FROM v_seams").rows.front().front(), "1");
}

TEST_F(OtherEngine, S17BeforeTheFirstStepAnyEngineWillDo) {
  tick();
  end_job("bed", JobEnd::kNodeFailed);
  settle_end();
  write_atomic(engine(), "second");
  tick(700.0);
  EXPECT_EQ(run("bed").state, State::kQueued);
}

TEST_F(Scenarios, S18APreemptedJobGoesOnFromItsCheckpoint) {
  tick();
  put_checkpoint("bed", 40);
  end_job("bed", JobEnd::kPreempted, "PREEMPTED");
  settle_end();
  EXPECT_EQ(newest("bed").start_step, 40);
  EXPECT_EQ(run("bed").failures, 0);
}

TEST_F(Scenarios, S18AJobStartedOverUnderItsOwnIdIsNotTakenForEnded) {
  tick();
  tick();
  end_engine("bed", EngineCode::kPaused, 40, 0.04, true);
  job_of("bed") = {job_name(newest("bed").token), "j1", JobPhase::kQueued, JobEnd::kNone, -1,
                   "PENDING (BeginTime)"};
  for (int i = 0; i < 5; ++i) tick(600.0);
  EXPECT_EQ(run("bed").state, State::kQueued);
  EXPECT_TRUE(scheduler_.cancelled.empty());
  EXPECT_EQ(store_->attempts().size(), 1u);
}

TEST_F(Scenarios, S19AKillAtTheWalltimeIsTriedAgainFiniteTimes) {
  for (int failure = 0; failure < 4; ++failure) {
    tick(4000.0);
    end_job("bed", JobEnd::kTimeout, "TIMEOUT");
    settle_end(3600.0);
  }
  EXPECT_EQ(run("bed").state, State::kFailed);
  EXPECT_NE(run("bed").reason.find("killed at its walltime without an outcome"), std::string::npos);
}

TEST_F(Scenarios, S20AJobThatMakesNoStepIsKilledAndTriedAgain) {
  tick();
  put_progress("bed", 40);
  tick(60.0);
  tick(1000.0);
  EXPECT_TRUE(scheduler_.cancelled.empty());
  tick(900.0);
  EXPECT_TRUE(scheduler_.cancelled.empty());  // the machine may have slept
  tick(60.0);
  ASSERT_FALSE(scheduler_.cancelled.empty());
  EXPECT_EQ(scheduler_.cancelled.back().second, CancelMode::kKill);
  EXPECT_NE(run("bed").reason.find("the job hangs and is killed"), std::string::npos);
  end_job("bed", JobEnd::kCancelled, "CANCELLED by 1000");
  settle_end();
  EXPECT_EQ(newest("bed").outcome_class, "INFRA");
  EXPECT_NE(newest("bed").reason.find("limits.hang"), std::string::npos);
  EXPECT_GT(newest("bed").hung_seconds, 1800.0);
  EXPECT_EQ(run("bed").state, State::kReady);
}

TEST_F(Scenarios, S20AJobThatMovesOrIsSuspendedDoesNotHang) {
  tick();
  for (int i = 1; i < 20; ++i) {
    put_progress("bed", i);
    tick(1700.0);
  }
  job_of("bed").detail = "SUSPENDED";
  for (int i = 0; i < 20; ++i) tick(1700.0);
  EXPECT_TRUE(scheduler_.cancelled.empty());
  EXPECT_EQ(run("bed").state, State::kRunning);
}

TEST_F(Scenarios, S20AMachineThatSleptKillsNothing) {
  tick();
  put_progress("bed", 40);
  tick(60.0);
  tick(28800.0);  // manager and engine slept alike
  put_progress("bed", 41);
  tick(60.0);
  tick(60.0);
  EXPECT_TRUE(scheduler_.cancelled.empty());
}

TEST_F(Scenarios, S21ABlowUpIsHeldAndNeverTriedBlindly) {
  tick();
  put_checkpoint("bed", 40);
  end_engine("bed", EngineCode::kBrokeDown, 55, 0.055);
  for (int i = 0; i < 5; ++i) tick(4000.0);
  EXPECT_EQ(run("bed").state, State::kHeld);
  EXPECT_EQ(run("bed").step, 40);
  EXPECT_EQ(scheduler_.requests.size(), 1u);
}

TEST_F(Scenarios, S22APersonsCancelIsRespectedAndAnAdministratorsIsNot) {
  settle_bed();
  tick();
  end_job("towed", JobEnd::kCancelled, "CANCELLED by 1000");
  end_job("slip_20", JobEnd::kDrained, "CANCELLED by 0");
  settle_end();
  EXPECT_EQ(run("towed").state, State::kHeld);
  EXPECT_EQ(run("slip_20").state, State::kReady);
  EXPECT_NE(newest("slip_20").reason.find("ended by an administrator"), std::string::npos);
}

TEST_F(Scenarios, S23AReusedJobIdIsNotOurs) {
  tick();
  // Another user's job got the number; ours is told by the token in its name.
  const JobStatus stranger{"other", newest("bed").job, JobPhase::kEnded, JobEnd::kFailed, 1, ""};
  scheduler_.jobs.clear();
  scheduler_.jobs["other"] = stranger;
  tick();
  EXPECT_EQ(run("bed").state, State::kUnknown);
}

class Limited : public Scenarios {
 protected:
  void limit(const std::string& limits) {
    launch(small_campaign(kTwoSlips,
                          "campaign: small\nscheduler: slurm\nresources: {walltime: "
                          "1h, nodes: 1}\nlimits: {" +
                              limits + "}\n"));
  }
};

TEST_F(Limited, S24AChainThatRunsAwayStopsAtItsNumberOfJobs) {
  limit("max_chunks: 3");
  for (int i = 1; i <= 6; ++i) {
    tick();
    if (run("bed").state == State::kHeld) break;
    put_checkpoint("bed", 10 * i);
    end_engine("bed", EngineCode::kPaused, 10 * i, 0.01 * i, true);
    end_job("bed", JobEnd::kTimeout);
  }
  tick();
  EXPECT_EQ(run("bed").state, State::kHeld);
  EXPECT_EQ(store_->attempts().size(), 3u);
  EXPECT_NE(run("bed").reason.find("limits.max_chunks: the run has had 3 jobs"), std::string::npos)
      << run("bed").reason;
}

TEST_F(Limited, S24ABusySchedulerUsesUpNoJobs) {
  limit("max_chunks: 3");
  for (int i = 0; i < 5; ++i) {
    scheduler_.next_answer = {SubmitAnswer::Kind::kBusy, "", "AssocMaxSubmitJobLimit"};
    tick(100.0);
  }
  tick(100.0);
  EXPECT_EQ(run("bed").state, State::kQueued);
}

TEST_F(Limited, S24TheNodeHoursAreNotExceededEvenIfEveryJobTakesItsWholeWalltime) {
  limit("node_hours: 2.5");
  settle_bed();
  tick();
  // Both wheel runs hold an hour each; half an hour is left.
  EXPECT_EQ(live_jobs(), 2u);
  end_job("towed", JobEnd::kTimeout);
  settle_end(3600.0);
  tick(700.0);
  EXPECT_EQ(run("towed").state, State::kHeld);
  EXPECT_NE(run("towed").reason.find("limits.node_hours"), std::string::npos);
}

TEST_F(Scenarios, S24ASuccessorThatNeverStartsIsShownWithTheSchedulersReason) {
  tick();
  JobStatus& job = job_of("bed");
  job.phase = JobPhase::kQueued;
  job.detail = "PENDING (DependencyNeverSatisfied)";
  tick();
  EXPECT_EQ(run("bed").state, State::kQueued);
  EXPECT_EQ(run("bed").reason, "PENDING (DependencyNeverSatisfied)");
}

}  // namespace
}  // namespace grouser
