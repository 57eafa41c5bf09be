// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "campaign/cli/exit_codes.hpp"
#include "diagnosis/cli/verbs.hpp"
#include "diagnosis/hypotheses/table.hpp"
#include "diagnosis/report/json.hpp"

namespace grouser::diagnosis {
namespace {

Diagnosis verdict(Word word) {
  Diagnosis d;
  d.recording = "one";
  d.word = word;
  if (word == Word::kNamed || word == Word::kProvisional) d.cause = "basset";
  return d;
}

TEST(Verdict, OfAMethodWithoutMeasuredRatesSaysSo) {
  for (const Word word : {Word::kNoMismatch, Word::kProvisional, Word::kNoneOfTheKnown}) {
    Diagnosis d = verdict(word);
    d.is_calibrated = false;
    const std::string text = sentence(d);
    EXPECT_NE(text.find("not calibrated"), std::string::npos) << text;
    const nlohmann::json json = nlohmann::json::parse(to_json(d));
    EXPECT_FALSE(json.at("calibrated").get<bool>());
    EXPECT_EQ(json.at("sentence").get<std::string>(), text);
    EXPECT_EQ(text.find("Provisionally: ") == 0, word != Word::kNoMismatch) << text;
    d.is_calibrated = true;
    EXPECT_EQ(sentence(d).find("not calibrated"), std::string::npos) << sentence(d);
  }
}

TEST(Verdict, OfOneRecordingOrAParameterIsNeverStrongerThanProvisional) {
  EXPECT_EQ(strongest_word(1, Family::kPhysics, true), Word::kProvisional);
  EXPECT_EQ(strongest_word(2, Family::kPhysics, true), Word::kNamed);
  EXPECT_EQ(strongest_word(9, Family::kParameter, true), Word::kProvisional);
  for (const std::size_t conditions : {1U, 2U, 3U, 30U})
    EXPECT_EQ(strongest_word(conditions, Family::kPhysics, false), Word::kProvisional);
}

/// What `grouser diagnose explain ID` prints.
std::string explained(const char* id) {
  CLI::App app;
  int code = -1;
  add_diagnose(app, code);
  ::testing::internal::CaptureStdout();
  app.parse(std::string("diagnose explain ") + id);
  std::string text = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(code, exit_codes::kOk);
  return text;
}

TEST(Explain, PrintsTheFourFieldsOfEveryHypothesis) {
  for (const Hypothesis& h : kHypotheses) {
    const std::string text = explained(h.id);
    const Explanation& e = h.explanation;
    EXPECT_EQ(text.find(std::string(h.id) + " (" + word_of(h.family) + "): " + h.title), 0U);
    for (const auto& [label, field] :
         {std::pair{"  shows      ", e.where}, std::pair{"  scaling    ", e.scaling},
          std::pair{"  confusers  ", e.confuser}, std::pair{"  breaker    ", e.breaker}}) {
      ASSERT_NE(field, nullptr) << h.id << label;
      EXPECT_NE(*field, '\0') << h.id << label;
      EXPECT_NE(text.find(std::string(label) + field + "\n"), std::string::npos) << text;
    }
  }
}

}  // namespace
}  // namespace grouser::diagnosis
