// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace grouser::diagnosis {

inline constexpr const char* kAnswerFile = "diagnosis.json";
inline constexpr const char* kRivalsFile = "rivals.json";

/// Folders `case_*` of a set of concealed cases, sorted. Local.
std::vector<std::string> case_names(const std::filesystem::path& folder);

/// How many of each kind are made.
struct CaseCounts {
  int nulls = 0;
  int singles = 0;
  int doubles = 0;
  int unlisted = 0;
};

/// Makes cases by the program `generator` and seals their truth. @throws StorageError. Local.
void make_cases(const std::filesystem::path& folder, const std::string& generator, unsigned seed,
                const CaseCounts& counts);

/// What a run left.
struct RunTally {
  int done = 0;    ///< now
  int before = 0;  ///< by earlier runs
  int failed = 0;
};

/// Diagnoses every case without an answer, `jobs` at a time, each in a process of its own; then
/// seals the answers. Ends after `most` cases. May be killed at any time and started again. The
/// truth stays closed. Local.
RunTally run_cases(const std::filesystem::path& folder, int jobs, int most);

}  // namespace grouser::diagnosis
