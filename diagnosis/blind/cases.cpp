// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/blind/cases.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "diagnosis/blind/rivals.hpp"
#include "diagnosis/blind/seal.hpp"
#include "diagnosis/inference/diagnose.hpp"
#include "diagnosis/report/json.hpp"

namespace grouser::diagnosis {
namespace {

namespace fs = std::filesystem;

void answer(const fs::path& folder) {
  std::vector<Problem> problems;
  const SeriesRecording recording = read_series_recording(folder, problems);
  if (!problems.empty()) throw ConfigError(problems);
  const fs::path file = folder / "baseline.yaml";
  const Baseline baseline = fs::exists(file) ? read_baseline(file.string()) : default_baseline();
  const Diagnosis d = diagnose(recording, baseline);
  write_atomic(folder / kRivalsFile, rivals_of(recording, baseline, d));
  write_atomic(folder / kAnswerFile, to_json(d));
}

/// In a child process, which ends here.
[[noreturn]] void answer_and_exit(const fs::path& folder) {
  try {
    answer(folder);
    ::_exit(0);
  } catch (const std::exception& error) {
    std::cerr << folder.string() << ": " << error.what() << "\n";
  }
  ::_exit(1);
}

/// @return whether the child that ended did well
bool wait_for_one() {
  int status = 0;
  ::wait(&status);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::vector<std::string> case_names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string().starts_with("case_"))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void make_cases(const fs::path& folder, const std::string& generator, unsigned seed,
                const CaseCounts& counts) {
  if (fs::exists(folder / kSealFile))
    throw StorageError(folder.string() + ": cases are there already; name another folder");
  std::vector<std::string> words{generator, folder.string(), std::to_string(seed)};
  for (const int count : {counts.nulls, counts.singles, counts.doubles, counts.unlisted})
    words.push_back(std::to_string(count));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(generator.c_str(), arguments.data());
    ::_exit(127);
  }
  if (child < 0 || !wait_for_one())
    throw StorageError(generator + ": the generator did not make the cases; is it built?");
  seal(folder);
}

RunTally run_cases(const fs::path& folder, int jobs, int most) {
  RunTally tally;
  int running = 0;
  int started = 0;
  std::cout << std::flush;
  const auto reap = [&] {
    --running;
    ++(wait_for_one() ? tally.done : tally.failed);
  };
  for (const std::string& name : case_names(folder)) {
    if (fs::exists(folder / name / kAnswerFile)) {
      ++tally.before;
      continue;
    }
    if (started == most) continue;
    ++started;
    if (running >= jobs) reap();
    const pid_t child = ::fork();
    if (child == 0) answer_and_exit(folder / name);
    if (child < 0) throw StorageError("no process could be started for " + name);
    ++running;
  }
  while (running > 0) reap();
  seal_answers(folder);
  return tally;
}

}  // namespace grouser::diagnosis
