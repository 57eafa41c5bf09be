// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/blind/seal.hpp"

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/hash.hpp"
#include "diagnosis/blind/cases.hpp"

namespace grouser::diagnosis {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  const std::optional<std::string> text = read_file(file);
  if (!text) throw FormatError(file.string() + ": no such file");
  return *text;
}

std::string answers_of(const fs::path& folder) {
  std::string text;
  for (const std::string& name : case_names(folder)) {
    const std::optional<std::string> answer = read_file(folder / name / kAnswerFile);
    text += name + " " + (answer ? hash_text(*answer) : std::string("none")) + "\n";
  }
  return text;
}

}  // namespace

void seal(const fs::path& folder) {
  const fs::path truth = folder / kTruthFile;
  write_atomic(folder / kSealFile, hash_text(text_of(truth)) + " " + kTruthFile + "\n");
  fs::permissions(truth, fs::perms::none);
}

std::string open_truth(const fs::path& folder) {
  const fs::path truth = folder / kTruthFile;
  fs::permissions(truth, fs::perms::owner_read);
  const std::string text = text_of(truth);
  if (text_of(folder / kSealFile) != hash_text(text) + " " + kTruthFile + "\n")
    throw FormatError(truth.string() + ": its hash is not the one in " + kSealFile +
                      "; it was changed after it was sealed");
  return text;
}

void seal_answers(const fs::path& folder) {
  write_atomic(folder / kAnswersFile, answers_of(folder));
}

void check_answers(const fs::path& folder) {
  if (text_of(folder / kAnswersFile) != answers_of(folder))
    throw FormatError((folder / kAnswersFile).string() +
                      ": an answer is not the one that was sealed; run `grouser blind run` again "
                      "before the truth is opened");
}

}  // namespace grouser::diagnosis
