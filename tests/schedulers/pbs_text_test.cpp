// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "schedulers/pbs.hpp"

namespace grouser {
namespace {

std::string job(const std::string& id, const std::string& attributes) {
  return "Job Id: " + id + "\n    Job_Name = g" + id + "\n" + attributes + "\n";
}

TEST(PbsText, QsubPrintsAnId) {
  EXPECT_EQ(parse_qsub("12.server\n"), "12.server");
  EXPECT_EQ(parse_qsub("12\n"), "12");
  for (const char* text : {"", "qsub: error", "12 server", "server.12"})
    EXPECT_EQ(parse_qsub(text), std::nullopt) << text;
}

TEST(PbsText, ContinuedLinesBelongToTheirAttribute) {
  const auto jobs = parse_qstat(job("1.s",
                                    "    job_state = R\n    Variable_List = A=1,\n"
                                    "\tB=2,job_state = F\n"));
  ASSERT_TRUE(jobs);
  ASSERT_EQ(jobs->size(), 1u);
  EXPECT_EQ(jobs->front().phase, JobPhase::kRunning);
  EXPECT_EQ(jobs->front().name, "g1.s");
}

TEST(PbsText, EndsAreToldApart) {
  const auto jobs = parse_qstat(
      job("1", "    job_state = F\n    Exit_status = 0\n") +
      job("2", "    job_state = F\n    Exit_status = 7\n") +
      job("3", "    job_state = F\n    Exit_status = 271\n") +
      job("4", "    job_state = F\n    Exit_status = -29\n") +
      job("5", "    job_state = F\n    Exit_status = -20\n") + job("6", "    job_state = F\n") +
      job("7",
          "    job_state = F\n    Exit_status = 271\n"
          "    comment = Job run and exceeded resource walltime\n") +
      job("8", "    job_state = Q\n") + job("9", "    job_state = F\n    Exit_status = 137\n"));
  ASSERT_TRUE(jobs);
  const std::vector<JobEnd> ends{JobEnd::kDone,    JobEnd::kFailed,     JobEnd::kKilled,
                                 JobEnd::kTimeout, JobEnd::kNodeFailed, JobEnd::kCancelled,
                                 JobEnd::kTimeout, JobEnd::kNone,       JobEnd::kKilled};
  ASSERT_EQ(jobs->size(), ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_EQ(jobs->at(i).end, ends[i]) << i + 1;
  EXPECT_EQ(jobs->at(2).exit_code, 128 + 15);
  EXPECT_EQ(jobs->at(7).phase, JobPhase::kQueued);
}

TEST(PbsText, GarbageIsNoAnswer) {
  for (const char* text : {"Job id            Name             User", "    job_state = R\n",
                           "Job Id: 1\n    job_state = R\n", "Job Id: 1\nnonsense\n"})
    EXPECT_EQ(parse_qstat(text), std::nullopt) << text;
  EXPECT_EQ(parse_qstat(job("1", "    job_state = ?\n")), std::nullopt);
  ASSERT_TRUE(parse_qstat(""));
}

TEST(PbsText, UnknownJobsDoNotSpoilTheAnswerAboutOthers) {
  EXPECT_TRUE(is_only_unknown_jobs("qstat: Unknown Job Id 5.s\n"));
  EXPECT_TRUE(is_only_unknown_jobs("qstat: 5.s Job has finished, use -x or -H\n"));
  EXPECT_FALSE(
      is_only_unknown_jobs("qstat: Unknown Job Id 5.s\nqstat: cannot connect to server\n"));
  EXPECT_FALSE(is_only_unknown_jobs(""));
}

}  // namespace
}  // namespace grouser
