// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "campaign/drive/decide.hpp"
#include "evidence.hpp"

namespace grouser {
namespace {

TEST(Look, AQuestionThatWasNotAnsweredEndsNothing) {
  Evidence evidence;
  evidence.why_not_answered = "squeue took too long";
  AttemptRow attempt = running_attempt();
  for (int i = 0; i < 100; ++i) {
    const Sighting sighting = look(attempt, evidence, policy(), kNow + 1000.0 * i);
    ASSERT_FALSE(sighting.ending);
    attempt = sighting.attempt;
  }
  EXPECT_EQ(attempt.state, State::kUnknown);
  EXPECT_EQ(attempt.reason, "cannot ask the scheduler: squeue took too long");
}

TEST(Look, AnAbsentJobIsGoneAfterTwoLooksAndTheGrace) {
  const Sighting first = look(running_attempt(), answered(), policy(), kNow);
  EXPECT_FALSE(first.ending);
  EXPECT_EQ(first.attempt.state, State::kUnknown);
  const Sighting soon = look(first.attempt, answered(), policy(), kNow + 30.0);
  EXPECT_FALSE(soon.ending);
  const Sighting later = look(soon.attempt, answered(), policy(), kNow + 61.0);
  ASSERT_TRUE(later.ending);
  EXPECT_EQ(later.ending->outcome_class, OutcomeClass::kInfra);
  // One look, however late, is not enough.
  EXPECT_FALSE(look(running_attempt(), answered(), policy(), kNow + 1e6).ending);
}

TEST(Look, AJobThatComesBackIsNotGone) {
  const Sighting first = look(running_attempt(), answered(), policy(), kNow);
  Evidence back = answered();
  back.job = job(JobPhase::kRunning);
  const Sighting second = look(first.attempt, back, policy(), kNow + 50.0);
  EXPECT_EQ(second.attempt.absences, 0);
  EXPECT_EQ(second.attempt.state, State::kRunning);
}

TEST(Look, ARunThatMovesIsAliveWhateverTheSchedulerSays) {
  const Sighting first = look(running_attempt(), answered(), policy(), kNow);
  Evidence moving = answered();
  moving.progress_step = 110;
  const Sighting second = look(first.attempt, moving, policy(), kNow + 1000.0);
  EXPECT_FALSE(second.ending);
  EXPECT_EQ(second.attempt.state, State::kRunning);
}

TEST(Look, ALostAnswerIsFoundByTheToken) {
  AttemptRow attempt = running_attempt();
  attempt.job.clear();
  attempt.state = State::kSubmitting;
  Evidence evidence = answered();
  evidence.job = job(JobPhase::kQueued);
  const Sighting sighting = look(attempt, evidence, policy(), kNow);
  EXPECT_EQ(sighting.attempt.job, "77");
  EXPECT_EQ(sighting.attempt.state, State::kQueued);
  EXPECT_EQ(sighting.attempt.submitted_at, kNow);
}

TEST(Look, TheJobsOwnRecordAlsoClosesALostAnswer) {
  AttemptRow attempt = running_attempt();
  attempt.job.clear();
  attempt.state = State::kSubmitting;
  Evidence evidence;  // the scheduler cannot be asked
  evidence.started = JobRecord{"abc123def456", "78", "host", -1};
  EXPECT_EQ(look(attempt, evidence, policy(), kNow).attempt.job, "78");
}

TEST(Look, AJobThatNeverArrivedIsNotTheRunsFault) {
  AttemptRow attempt = running_attempt();
  attempt.job.clear();
  attempt.state = State::kSubmitting;
  const Sighting first = look(attempt, answered(), policy(), kNow);
  EXPECT_EQ(first.attempt.state, State::kSubmitting);
  const Sighting second = look(first.attempt, answered(), policy(), kNow + 61.0);
  ASSERT_TRUE(second.ending);
  EXPECT_FALSE(second.ending->was_submitted);
  const Change change = settle(running_run(), ChunkRow{}, second.attempt, *second.ending,
                               answered(), policy(), kNow + 61.0);
  EXPECT_EQ(change.run->state, State::kReady);
  EXPECT_EQ(change.run->failures, 0);
  EXPECT_EQ(change.attempt->state, State::kCancelled);
}

TEST(Look, AnOutcomeWaitsForItsJobToEndButNotForEver) {
  Evidence evidence = answered();
  evidence.outcome = outcome(EngineCode::kPaused, 150, 0.15);
  evidence.job = job(JobPhase::kRunning);
  const Sighting first = look(running_attempt(), evidence, policy(), kNow);
  EXPECT_FALSE(first.ending);
  const Sighting hung = look(first.attempt, evidence, policy(), kNow + 61.0);
  EXPECT_TRUE(hung.ending);
  EXPECT_TRUE(hung.must_cancel);
  evidence.exit = exit_record(10);
  const Sighting ended = look(first.attempt, evidence, policy(), kNow + 1.0);
  EXPECT_TRUE(ended.ending);
  EXPECT_FALSE(ended.must_cancel);
}

// scancel also sends TERM: only the scheduler tells a person's cancel from the walltime.
TEST(Look, APauseBySignalWaitsForTheSchedulersWord) {
  Evidence evidence = answered();
  evidence.outcome = outcome(EngineCode::kPaused, 150, 0.15);
  evidence.outcome->by_signal = true;
  evidence.exit = exit_record(10);
  evidence.job = job(JobPhase::kRunning);
  EXPECT_FALSE(look(running_attempt(), evidence, policy(), kNow).ending);
  evidence.job = job(JobPhase::kEnded, JobEnd::kTimeout);
  EXPECT_EQ(look(running_attempt(), evidence, policy(), kNow).ending->outcome_class,
            OutcomeClass::kContinue);
  evidence.job = job(JobPhase::kEnded, JobEnd::kCancelled);
  EXPECT_EQ(look(running_attempt(), evidence, policy(), kNow).ending->outcome_class,
            OutcomeClass::kUser);
}

TEST(Look, APauseWithoutASignalIsBelievedWhateverBecameOfTheJob) {
  Evidence evidence = answered();
  evidence.outcome = outcome(EngineCode::kPaused, 150, 0.15);
  evidence.exit = exit_record(10);
  evidence.job = job(JobPhase::kRunning);
  EXPECT_EQ(look(running_attempt(), evidence, policy(), kNow).ending->outcome_class,
            OutcomeClass::kContinue);
  evidence.job = job(JobPhase::kEnded, JobEnd::kCancelled);
  EXPECT_EQ(look(running_attempt(), evidence, policy(), kNow).ending->outcome_class,
            OutcomeClass::kContinue);
}

TEST(Look, OnSharedFileSystemsAnEndIsLookedAtTwiceBeforeTheOutcomeIsMissed) {
  Policy patient = policy();
  patient.end_looks = 2;
  Evidence evidence = answered();
  evidence.job = job(JobPhase::kEnded, JobEnd::kFailed, 10);
  const Sighting first = look(running_attempt(), evidence, patient, kNow);
  EXPECT_FALSE(first.ending);
  EXPECT_TRUE(look(first.attempt, evidence, patient, kNow + 1.0).ending);
  evidence.outcome = outcome(EngineCode::kPaused, 150, 0.15);
  EXPECT_EQ(look(first.attempt, evidence, patient, kNow + 1.0).ending->outcome_class,
            OutcomeClass::kContinue);
}

}  // namespace
}  // namespace grouser
