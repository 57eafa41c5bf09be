// SPDX-License-Identifier: BSD-3-Clause
// Whatever a batch system prints, its words are read or refused, and nothing else happens.
#include <gtest/gtest.h>

#include <random>

#include "base/errors.hpp"
#include "base/run_contract.hpp"
#include "schedulers/pbs.hpp"
#include "schedulers/scripts.hpp"
#include "schedulers/slurm.hpp"

namespace grouser {
namespace {

const std::vector<std::string> kSeeds{
    "12|gabc|PENDING|AssocMaxJobsLimit\n7_0|gdef|RUNNING|None\n7_[1-12%2]|gabc|PENDING|0:0\n",
    "1|a|COMPLETED|0:0\n4|d|CANCELLED by 1000|0:0\n8|h|OUT_OF_MEMORY|0:125\n",
    "1234;cluster\n",
    "Job Id: 12.srv\n    Job_Name = gabc\n    job_state = F\n    Exit_status = -29\n"
    "    Variable_List = A=b,\n\tPATH=/usr/bin\n\n",
    "{\"token\": \"abc\", \"job\": \"7\", \"host\": \"n1\", \"code\": -1}\n",
    to_json(Outcome{}),
    to_json(Event{}),
    to_json(CheckpointManifest{}),
    to_json(Progress{}),
};

// One to eight bytes changed, added, taken away or copied from another seed.
std::string mutated(std::mt19937& random) {
  const auto pick = [&](std::size_t count) {
    return static_cast<std::size_t>(random()) % std::max<std::size_t>(count, 1);
  };
  std::string text = kSeeds[pick(kSeeds.size())];
  for (std::size_t i = 0, n = 1 + pick(8); i < n; ++i) {
    const std::size_t at = pick(text.size());
    const std::string& other = kSeeds[pick(kSeeds.size())];
    switch (pick(5)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.insert(at, 1, static_cast<char>(random()));
        break;
      case 2:
        text.erase(at, pick(9));
        break;
      case 3:
        text.insert(at, other.substr(pick(other.size()), pick(40)));
        break;
      default:
        text.insert(at, "99999999999999999999999");
    }
  }
  return text;
}

template <class Read>
void expect_record_or_refusal(const Read& read, const std::string& text) {
  try {
    read(text, "fuzz");
  } catch (const FormatError&) {
  }
}

TEST(Fuzz, WordsOfBatchSystemsAndRecordsAreReadOrRefused) {
  std::mt19937 random(20260101);
  for (int i = 0; i < 3000; ++i) {
    const std::string text = mutated(random);
    SCOPED_TRACE(text);
    parse_sbatch(text);
    parse_squeue(text);
    parse_sacct(text);
    parse_qsub(text);
    parse_qstat(text);
    judge_sbatch_failure(text);
    expect_record_or_refusal(job_record_from_json, text);
    expect_record_or_refusal(outcome_from_json, text);
    expect_record_or_refusal(event_from_json, text);
    expect_record_or_refusal(manifest_from_json, text);
    expect_record_or_refusal(progress_from_json, text);
  }
}

}  // namespace
}  // namespace grouser
