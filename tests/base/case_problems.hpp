// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/case.hpp"

namespace grouser {

/// All that is wrong with a case, one line each.
inline std::string problems_of(const std::string& text) {
  std::vector<Problem> problems;
  read_case(parse_yaml(text, "case.yaml"), problems);
  std::string all;
  for (const Problem& problem : problems) all += problem.text() + "\n";
  return all;
}

/// `text` with `to` in place of `from`, which must be there.
inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace grouser
