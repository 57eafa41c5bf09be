// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

#include "base/errors.hpp"
#include "diagnosis/blind/cases.hpp"
#include "diagnosis/blind/score.hpp"
#include "diagnosis/blind/seal.hpp"

namespace grouser::diagnosis {
namespace {

namespace fs = std::filesystem;

fs::path empty_folder() {
  const fs::path folder =
      fs::path(testing::TempDir()) /
      ("blind_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  fs::remove_all(folder);
  fs::create_directories(folder / "sealed");
  return folder;
}

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// Three cases: nothing (rightly silent), basset (named with 0.9 of the odds), a magnet (named).
fs::path answered_folder() {
  const fs::path folder = empty_folder();
  write(folder / kTruthFile, R"({"tier": "t0", "cases": [
    {"case": "case_001", "kind": "null", "secrets": [], "fitted_runs": 3, "amplitude": 0, "masks": {}},
    {"case": "case_002", "kind": "single", "secrets": ["basset"], "fitted_runs": 3, "amplitude": 1.1,
     "masks": {"A": "0011"}},
    {"case": "case_003", "kind": "unlisted", "secrets": ["magnet"], "fitted_runs": 3, "amplitude": 0,
     "masks": {}}]})");
  write(folder / "case_001" / kAnswerFile, R"({"verdict": "no_mismatch", "cause": ""})");
  write(folder / "case_002" / kAnswerFile,
        R"({"verdict": "named", "cause": "basset", "probability": 0.9, "set": ["basset"],
        "amplitude": {"value": 1.0, "deviation": 0.1},
        "locations": [{"condition": "A", "mask": "0111"}],
        "held_out": [{"baseline_error": 0.1, "candidate_error": 0.02, "noise_error": 0.01}]})");
  write(folder / "case_003" / kAnswerFile,
        R"({"verdict": "named", "cause": "drift", "probability": 0.99, "set": ["drift"]})");
  seal(folder);
  seal_answers(folder);
  return folder;
}

const Rate& rate_of(const Score& score, const std::string& key) {
  for (const Mark& mark : score.marks)
    if (mark.key == key) return mark.rate;
  throw std::runtime_error(key);
}

TEST(Blind, BoundsOfAShareAreThoseOfClopperAndPearson) {
  // None of 30: 1 - 0.025^(1/30). All of 30: 0.025^(1/30). 5 of 20: tables give 0.0866 to 0.4910.
  EXPECT_NEAR(share_of(0, 30).hi, 1.0 - std::pow(0.025, 1.0 / 30.0), 1e-9);
  EXPECT_EQ(share_of(0, 30).lo, 0.0);
  EXPECT_NEAR(share_of(30, 30).lo, std::pow(0.025, 1.0 / 30.0), 1e-9);
  EXPECT_NEAR(share_of(5, 20).lo, 0.0866, 5e-5);
  EXPECT_NEAR(share_of(5, 20).hi, 0.4910, 5e-5);
}

TEST(Blind, ATruthThatWasChangedAfterSealingIsRefused) {
  const fs::path folder = answered_folder();
  EXPECT_NO_THROW(open_truth(folder));
  fs::permissions(folder / kTruthFile, fs::perms::owner_all);
  std::ofstream(folder / kTruthFile, std::ios::app) << "\n";
  EXPECT_THROW(score_cases(folder), FormatError);
}

TEST(Blind, AnAnswerThatWasChangedAfterSealingIsRefused) {
  const fs::path folder = answered_folder();
  std::ofstream(folder / "case_003" / kAnswerFile) << R"({"verdict": "none_of_the_known"})";
  EXPECT_THROW(score_cases(folder), FormatError);
}

TEST(Blind, ScoreCountsWhatWasSaidAgainstWhatWasConcealed) {
  const Score score = score_cases(answered_folder());
  EXPECT_EQ(score.cases, 3);
  EXPECT_EQ(rate_of(score, "false_alarm").value, 0.0);
  EXPECT_EQ(rate_of(score, "top1").value, 1.0);
  EXPECT_EQ(rate_of(score, "set_coverage").value, 1.0);
  EXPECT_EQ(rate_of(score, "out_of_catalogue_flagged").value, 0.0);
  EXPECT_NEAR(rate_of(score, "confident_wrong").value, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(rate_of(score, "localisation_overlap").value, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(rate_of(score, "held_out_ratio").value, 0.2, 1e-12);
  EXPECT_EQ(rate_of(score, "amplitude_coverage").value, 1.0);
  // Of the two that named: 0.9 and right, 0.99 and wrong, a bin each.
  EXPECT_NEAR(rate_of(score, "ece").value, (0.1 + 0.99) / 2.0, 1e-12);
  ASSERT_EQ(score.failures.size(), 1U);
  EXPECT_EQ(score.failures[0].find("case_003"), 0U);
  const nlohmann::json json = nlohmann::json::parse(to_json(score));
  EXPECT_EQ(json.at("t0").at("top1_count"), 1);
  EXPECT_TRUE(json.at("t0").at("baselines").contains("sindy"));
}

TEST(Blind, AFewSealedCasesOfAnotherProgramAreAnswered) {
  const fs::path folder = empty_folder();
  fs::remove_all(folder);
  make_cases(folder, BLIND_SPHERES, 5, {3, 4, 0, 1});
  EXPECT_THROW(make_cases(folder, BLIND_SPHERES, 5, {1, 0, 0, 0}), StorageError);
  EXPECT_EQ(run_cases(folder, 2, 2).done, 2);
  EXPECT_EQ(score_cases(folder, "", true).cases, 2);
  EXPECT_EQ(run_cases(folder, 2, -1).done, 6);
  EXPECT_EQ(run_cases(folder, 2, -1).before, 8);
  const Score score = score_cases(folder);
  std::cout << to_text(score);
  EXPECT_EQ(score.unanswered, 0);
  EXPECT_EQ(rate_of(score, "false_alarm").value, 0.0);
  // The whole set is measured in docs/diagnosis/blind.md; here a method that guesses would fail.
  EXPECT_GE(rate_of(score, "top1_all").value, 0.5);
  EXPECT_EQ(rate_of(score, "confident_wrong").value, 0.0);
}

}  // namespace
}  // namespace grouser::diagnosis
