// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace grouser {

/// One thing wrong with an input: where it stands, what is wrong and what to do about it.
struct Problem {
  std::string file;
  int line = 0;    ///< 1-based; 0 when the file as a whole is meant
  int column = 0;  ///< 1-based; 0 when the line as a whole is meant
  std::string key;
  std::string problem;
  std::string hint;

  /// `file:line:col: key: problem; hint`
  std::string text() const;
};

/// Input that cannot be used as written (engine exit code 20). Carries every problem of the input,
/// so that a user mends them in one go.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<Problem> problems);
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// A file of ours that is damaged, of an unknown version, or belongs to something else
/// (engine exit code 21).
class FormatError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file system refused: full, quota, read-only, gone (engine exit code 40).
class StorageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The nearest of `known` to `word` by edit distance, or "" when none is close. Local.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

}  // namespace grouser
