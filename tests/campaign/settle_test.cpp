// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "campaign/drive/decide.hpp"
#include "evidence.hpp"

namespace grouser {
namespace {

struct Row {
  EngineCode code;
  const char* request;
  bool by_signal;
  bool progressed;
  const char* outcome_class;
  State run;
  State attempt;
  State chunk;
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << word_of(row.code) << " request '" << row.request << "'"
       << (row.by_signal ? " by signal" : "") << (row.progressed ? " with progress" : "");
}

std::string name_of(const ::testing::TestParamInfo<Row>& row) {
  std::string name = word_of(row.param.code);
  if (*row.param.request != '\0') name += std::string("_") + row.param.request;
  if (row.param.by_signal) name += "_signal";
  return name + (row.param.progressed ? "_progressed" : "");
}

class Outcomes : public ::testing::TestWithParam<Row> {};

TEST_P(Outcomes, DecideWhatComesNext) {
  const Row& row = GetParam();
  Evidence evidence = answered();
  evidence.outcome = outcome(row.code, row.progressed ? 150 : 100, row.progressed ? 0.15 : 0.1);
  if (row.progressed) evidence.newest = checkpoint(150);
  evidence.exit = exit_record(static_cast<int>(row.code));
  evidence.job = job(JobPhase::kEnded, JobEnd::kFailed, static_cast<int>(row.code));
  evidence.outcome->by_signal = row.by_signal;
  RunRow run = running_run();
  run.request = row.request;
  ChunkRow chunk;
  chunk.until_time = 0.2;
  const Sighting sighting = look(running_attempt(), evidence, policy(), kNow);
  ASSERT_TRUE(sighting.ending);
  const Change change =
      settle(run, chunk, sighting.attempt, *sighting.ending, evidence, policy(), kNow);
  EXPECT_EQ(change.attempt->outcome_class, row.outcome_class);
  EXPECT_STREQ(word_of(change.run->state), word_of(row.run));
  EXPECT_STREQ(word_of(change.attempt->state), word_of(row.attempt));
  EXPECT_STREQ(word_of(change.chunk->state), word_of(row.chunk));
  EXPECT_EQ(change.run->request, "");
  EXPECT_EQ(change.attempt->ended_at, kNow);
}

INSTANTIATE_TEST_SUITE_P(Table, Outcomes,
                         ::testing::Values(
                             // code, request, by signal, progress -> class, run, attempt, chunk
                             Row{EngineCode::kFinished, "", false, true, "DONE", State::kCompleted,
                                 State::kCompleted, State::kCompleted},
                             Row{EngineCode::kFinished, "cancel", false, true, "DONE",
                                 State::kCompleted, State::kCompleted, State::kCompleted},
                             Row{EngineCode::kSteady, "", false, true, "DONE", State::kSteady,
                                 State::kSteady, State::kSteady},
                             Row{EngineCode::kPaused, "", false, true, "CONTINUE",
                                 State::kChunkDone, State::kChunkDone, State::kChunkDone},
                             Row{EngineCode::kPaused, "", false, false, "PLUMBING", State::kReady,
                                 State::kFailed, State::kReady},
                             Row{EngineCode::kPaused, "stop", false, true, "CONTINUE", State::kHeld,
                                 State::kChunkDone, State::kChunkDone},
                             Row{EngineCode::kPaused, "cancel", false, true, "CONTINUE",
                                 State::kCancelled, State::kCancelled, State::kCancelled},
                             Row{EngineCode::kStopped, "stop", false, true, "USER", State::kHeld,
                                 State::kChunkDone, State::kHeld},
                             Row{EngineCode::kStopped, "", false, true, "USER", State::kHeld,
                                 State::kChunkDone, State::kHeld},
                             Row{EngineCode::kPaused, "", true, true, "CONTINUE", State::kChunkDone,
                                 State::kChunkDone, State::kChunkDone},
                             Row{EngineCode::kPaused, "cancel", true, true, "CONTINUE",
                                 State::kCancelled, State::kCancelled, State::kCancelled},
                             Row{EngineCode::kInputRefused, "", false, false, "USER", State::kHeld,
                                 State::kFailed, State::kHeld},
                             Row{EngineCode::kCheckpointRefused, "", false, false, "RESOURCE",
                                 State::kHeld, State::kFailed, State::kHeld},
                             Row{EngineCode::kFenceLost, "", false, false, "PLUMBING",
                                 State::kReady, State::kFailed, State::kReady},
                             Row{EngineCode::kBrokeDown, "", false, true, "PHYSICS", State::kHeld,
                                 State::kFailed, State::kHeld},
                             Row{EngineCode::kStorageFailed, "", false, true, "RESOURCE",
                                 State::kHeld, State::kFailed, State::kHeld},
                             Row{EngineCode::kParallelFailed, "", false, false, "INFRA",
                                 State::kReady, State::kFailed, State::kReady},
                             Row{EngineCode::kParallelFailed, "stop", false, false, "INFRA",
                                 State::kHeld, State::kFailed, State::kHeld},
                             Row{EngineCode::kDefect, "", false, true, "DEFECT", State::kHeld,
                                 State::kFailed, State::kHeld}),
                         name_of);

struct EndRow {
  JobEnd end;
  int code;
  bool has_exit_record;
  const char* outcome_class;
  State run;
};

void PrintTo(const EndRow& row, std::ostream* out) {
  *out << "end " << static_cast<int>(row.end) << " code " << row.code;
}

class EndsWithoutOutcome : public ::testing::TestWithParam<EndRow> {};

TEST_P(EndsWithoutOutcome, DecideWhatComesNext) {
  const EndRow& row = GetParam();
  Evidence evidence = answered();
  evidence.job = job(JobPhase::kEnded, row.end, row.code);
  if (row.has_exit_record) evidence.exit = exit_record(row.code);
  const Sighting sighting = look(running_attempt(), evidence, policy(), kNow);
  ASSERT_TRUE(sighting.ending);
  const Change change = settle(running_run(), ChunkRow{}, sighting.attempt, *sighting.ending,
                               evidence, policy(), kNow);
  EXPECT_EQ(change.attempt->outcome_class, row.outcome_class) << change.attempt->reason;
  EXPECT_STREQ(word_of(change.run->state), word_of(row.run));
}

INSTANTIATE_TEST_SUITE_P(
    Table, EndsWithoutOutcome,
    ::testing::Values(EndRow{JobEnd::kKilled, 137, true, "INFRA", State::kReady},
                      EndRow{JobEnd::kKilled, -1, false, "INFRA", State::kReady},
                      EndRow{JobEnd::kDone, 0, true, "INFRA", State::kReady},
                      EndRow{JobEnd::kFailed, 10, true, "INFRA", State::kReady},
                      EndRow{JobEnd::kFailed, 30, true, "PHYSICS", State::kHeld},
                      EndRow{JobEnd::kFailed, 40, false, "RESOURCE", State::kHeld},
                      EndRow{JobEnd::kFailed, 127, true, "USER", State::kHeld},
                      EndRow{JobEnd::kTimeout, -1, false, "INFRA", State::kReady},
                      EndRow{JobEnd::kNodeFailed, -1, false, "INFRA", State::kReady},
                      EndRow{JobEnd::kOutOfMemory, 125, false, "RESOURCE", State::kHeld},
                      EndRow{JobEnd::kCancelled, -1, false, "USER", State::kHeld}),
    [](const auto& row) {
      return "end_" + std::to_string(static_cast<int>(row.param.end)) +
             (row.param.code < 0 ? "" : "_code_" + std::to_string(row.param.code));
    });

TEST(Settle, FailuresWithoutProgressAreCountedAndGivenUpAfterTheLimit) {
  RunRow run = running_run();
  ChunkRow chunk;
  Evidence evidence = answered();
  const Ending ending{OutcomeClass::kInfra, 137, "killed"};
  for (int failure = 1; failure <= 3; ++failure) {
    run = *settle(run, chunk, running_attempt(), ending, evidence, policy(), kNow).run;
    EXPECT_EQ(run.state, State::kReady);
    EXPECT_EQ(run.failures, failure);
  }
  run = *settle(run, chunk, running_attempt(), ending, evidence, policy(), kNow).run;
  EXPECT_EQ(run.state, State::kFailed);
  EXPECT_EQ(run.reason, "4 attempts in a row without progress; last: killed");
}

TEST(Settle, ProgressStartsTheCountAfresh) {
  RunRow run = running_run();
  run.failures = 3;
  Evidence evidence = answered();
  evidence.newest = checkpoint(120);
  const Change change = settle(run, ChunkRow{}, running_attempt(),
                               {OutcomeClass::kInfra, 137, "killed"}, evidence, policy(), kNow);
  EXPECT_EQ(change.run->state, State::kReady);
  EXPECT_EQ(change.run->failures, 1);
  EXPECT_EQ(change.run->step, 120);
  EXPECT_EQ(change.run->state_hash, "newest");
}

TEST(Settle, WalltimeInsideAChunkLeavesTheRestAsAChunkOfItsOwn) {
  Evidence evidence = answered();
  evidence.outcome = outcome(EngineCode::kPaused, 150, 0.15);
  ChunkRow chunk;
  chunk.position = 2;
  chunk.until_time = 0.2;
  const Ending ending{OutcomeClass::kContinue, 10, "walltime"};
  const Change change =
      settle(running_run(), chunk, running_attempt(), ending, evidence, policy(), kNow);
  EXPECT_EQ(change.chunk->state, State::kChunkDone);
  EXPECT_EQ(change.chunk->time, 0.15);
  ASSERT_TRUE(change.chunk_after);
  EXPECT_EQ(change.chunk_after->position, 3);
  EXPECT_EQ(change.chunk_after->until_time, 0.2);
  evidence.outcome = outcome(EngineCode::kPaused, 200, 0.2);
  EXPECT_FALSE(settle(running_run(), chunk, running_attempt(), ending, evidence, policy(), kNow)
                   .chunk_after);
}

// Killed between its last checkpoint and its outcome, then run again: no step, and yet all done.
TEST(Settle, APauseAtTheEndOfTheChunkNeedsNoStep) {
  RunRow run = running_run();
  run.step = 200;
  AttemptRow attempt = running_attempt();
  attempt.start_step = 200;
  ChunkRow chunk;
  chunk.until_time = 0.2;
  Evidence evidence = answered();
  evidence.outcome = outcome(EngineCode::kPaused, 200, 0.2);
  const Change change =
      settle(run, chunk, attempt, {OutcomeClass::kContinue, 10, ""}, evidence, policy(), kNow);
  EXPECT_EQ(change.run->state, State::kChunkDone);
  EXPECT_EQ(change.run->failures, 0);
}

// The signal was a person's: nothing failed, and nothing goes on by itself.
TEST(Settle, AScancelHoldsTheRunAtItsCheckpoint) {
  Evidence evidence = answered();
  evidence.outcome = outcome(EngineCode::kPaused, 150, 0.15);
  evidence.outcome->by_signal = true;
  evidence.job = job(JobPhase::kEnded, JobEnd::kCancelled);
  const Sighting sighting = look(running_attempt(), evidence, policy(), kNow);
  ASSERT_TRUE(sighting.ending);
  const Change change = settle(running_run(), ChunkRow{}, sighting.attempt, *sighting.ending,
                               evidence, policy(), kNow);
  EXPECT_EQ(change.run->state, State::kHeld);
  EXPECT_EQ(change.run->reason, "the job was cancelled (WORD)");
  EXPECT_EQ(change.run->step, 150);
  EXPECT_EQ(change.attempt->state, State::kChunkDone);
}

// A broken-down run stays at its last good checkpoint, whatever step it broke at.
TEST(Settle, ABreakdownKeepsTheLastGoodCheckpoint) {
  Evidence evidence = answered();
  evidence.outcome = outcome(EngineCode::kBrokeDown, 177, 0.177);
  evidence.newest = checkpoint(140);
  const Change change = settle(running_run(), ChunkRow{}, running_attempt(),
                               {OutcomeClass::kPhysics, 30, "NaN"}, evidence, policy(), kNow);
  EXPECT_EQ(change.run->step, 140);
  EXPECT_EQ(change.attempt->step, 177);
}

}  // namespace
}  // namespace grouser
