// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace grouser::diagnosis {

/// A share of cases with the bounds that contain the true one with 95 % (Clopper and Pearson 1934),
/// or a median or mean with bounds from 1000 resamples of the cases.
struct Rate {
  double value = 0.0;
  double lo = 0.0;
  double hi = 1.0;
  int count = 0;  ///< cases that it is about
};

/// Share `hits` of `count`. Local.
Rate share_of(int hits, int count);

/// One line of a score: a key of the JSON file.
struct Mark {
  std::string key;
  std::string words;  ///< for people
  Rate rate;
  bool is_share = true;
};

/// What a rival method got right of the same cases.
struct RivalMark {
  std::string name;
  Rate false_alarm;
  Rate top1;
};

/// A scored set.
struct Score {
  std::string tier;
  int cases = 0;
  int unanswered = 0;
  std::vector<Mark> marks;
  std::vector<RivalMark> rivals;
  std::vector<std::string> failures;  ///< one line per case that was not answered right
};

/// Opens the truth of `folder` and scores its answers. `half`: `development`, `test` or both (``).
/// A case without an answer counts as wrong, or not at all when `is_answered_only`: the numbers of
/// cases do not tell their kind, so the first ones are a fair sample. @throws FormatError. Local.
Score score_cases(const std::filesystem::path& folder, const std::string& half = "",
                  bool is_answered_only = false);

/// Keys as in docs/reference/formats/blind.md.
std::string to_json(const Score& score);
std::string to_text(const Score& score);

}  // namespace grouser::diagnosis
