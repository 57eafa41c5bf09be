// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <unistd.h>

#include "schedulers/slurm.hpp"

namespace grouser {
namespace {

TEST(SlurmText, SbatchIdComesWithAndWithoutCluster) {
  EXPECT_EQ(parse_sbatch("1234\n"), "1234");
  EXPECT_EQ(parse_sbatch("1234;big\n"), "1234");
  EXPECT_EQ(parse_sbatch("Welcome!\n1234\n"), "1234");
  for (const char* text : {"", "\n", "Submitted batch job 12", "abc", ";big"})
    EXPECT_EQ(parse_sbatch(text), std::nullopt) << text;
}

TEST(SlurmText, ATimedOutSbatchMayHaveSubmitted) {
  EXPECT_EQ(judge_sbatch_failure("sbatch: error: Batch job submission failed: Socket timed out on "
                                 "send/recv operation"),
            SubmitAnswer::Kind::kUnclear);
}

TEST(SlurmText, AnUnreachableControllerAndAFullQuotaAreTriedLater) {
  for (const char* text :
       {"sbatch: error: Unable to contact slurm controller (connect failure)",
        "sbatch: error: AssocMaxSubmitJobLimit\nsbatch: error: Batch job submission failed: Job "
        "violates accounting/QOS policy",
        "sbatch: error: QOSMaxSubmitJobPerUserLimit"})
    EXPECT_EQ(judge_sbatch_failure(text), SubmitAnswer::Kind::kBusy) << text;
}

TEST(SlurmText, AWrongAccountIsRefused) {
  for (const char* text : {"Invalid account or account/partition combination specified",
                           "invalid partition specified: nope", "Invalid qos specification",
                           "QOSMaxWallDurationPerJobLimit"})
    EXPECT_EQ(judge_sbatch_failure(text), SubmitAnswer::Kind::kRefused) << text;
}

TEST(SlurmText, SqueueTellsWaitingFromRunning) {
  const auto jobs = parse_squeue(
      "12|gabc|PENDING|AssocMaxJobsLimit\n13|gdef|RUNNING|None\n"
      "14|gghi|COMPLETING|None\n");
  ASSERT_TRUE(jobs);
  ASSERT_EQ(jobs->size(), 3u);
  EXPECT_EQ(jobs->at(0).phase, JobPhase::kQueued);
  EXPECT_EQ(jobs->at(0).detail, "PENDING (AssocMaxJobsLimit)");
  EXPECT_EQ(jobs->at(1).phase, JobPhase::kRunning);
  EXPECT_EQ(jobs->at(1).name, "gdef");
  EXPECT_EQ(jobs->at(2).phase, JobPhase::kRunning);
}

TEST(SlurmText, AnEmptyQueueIsAnAnswerAndGarbageIsNone) {
  ASSERT_TRUE(parse_squeue(""));
  EXPECT_TRUE(parse_squeue("")->empty());
  for (const char* text : {"JOBID PARTITION NAME", "12|gabc|PENDING", "x|gabc|RUNNING|None",
                           "12|gabc|DANCING|None", "12|gabc|RUNNING|None|more"})
    EXPECT_EQ(parse_squeue(text), std::nullopt) << text;
}

TEST(SlurmText, SacctEndsAreToldApart) {
  const auto jobs =
      parse_sacct("1|a|COMPLETED|0:0\n2|b|FAILED|7:0\n3|c|FAILED|0:9\n4|d|CANCELLED by " +
                  std::to_string(::getuid()) +
                  "|0:0\n"
                  "5|e|TIMEOUT|0:0\n6|f|PREEMPTED|0:0\n7|g|NODE_FAIL|0:0\n8|h|OUT_OF_MEMORY|0:125\n"
                  "9|i|RUNNING|0:0\n");
  ASSERT_TRUE(jobs);
  const std::vector<JobEnd> ends{JobEnd::kDone,       JobEnd::kFailed,      JobEnd::kKilled,
                                 JobEnd::kCancelled,  JobEnd::kTimeout,     JobEnd::kPreempted,
                                 JobEnd::kNodeFailed, JobEnd::kOutOfMemory, JobEnd::kNone};
  ASSERT_EQ(jobs->size(), ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_EQ(jobs->at(i).end, ends[i]) << i;
  EXPECT_EQ(jobs->at(1).exit_code, 7);
  EXPECT_EQ(jobs->at(2).exit_code, 137);
  EXPECT_EQ(jobs->at(8).exit_code, -1);
}

TEST(SlurmText, TasksOfAnArrayAreToldApartByTheirIndex) {
  const auto queue = parse_squeue("7_0|gabc|RUNNING|None\n7_12|gabc|PENDING|JobArrayTaskLimit\n");
  ASSERT_TRUE(queue);
  EXPECT_EQ(queue->at(1).name, "gabc_12");
  EXPECT_EQ(queue->at(1).id, "7_12");
  // Those that wait stand on one line, which the queue has better.
  const auto books = parse_sacct("7_0|gabc|FAILED|3:0\n7_[1-12%2]|gabc|PENDING|0:0\n");
  ASSERT_TRUE(books);
  ASSERT_EQ(books->size(), 1u);
  EXPECT_EQ(books->at(0).name, "gabc_0");
  EXPECT_EQ(parse_squeue("7_x|gabc|RUNNING|None\n"), std::nullopt);
}

TEST(SlurmText, SomebodyElsesCancelIsNotOurs) {
  const auto jobs = parse_sacct("4|d|CANCELLED by " + std::to_string(::getuid() + 1) + "|0:0\n");
  ASSERT_TRUE(jobs);
  EXPECT_EQ(jobs->front().end, JobEnd::kDrained);
}

TEST(SlurmText, SacctGarbageIsNoAnswer) {
  for (const char* text : {"1|a|COMPLETED|zero", "1|a|COMPLETED|0", "1|a", "a|b|c|d"})
    EXPECT_EQ(parse_sacct(text), std::nullopt) << text;
}

}  // namespace
}  // namespace grouser
