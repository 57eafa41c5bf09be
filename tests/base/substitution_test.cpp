// SPDX-License-Identifier: BSD-3-Clause
#include "base/substitution.hpp"

#include <gtest/gtest.h>

namespace grouser {
namespace {

using Names = std::vector<std::string>;

TEST(Substitution, NamesAreWhatBracesHoldOnce) {
  EXPECT_EQ(names_in_braces("srun -n {ranks} --x={a_1}{ranks}"), (Names{"ranks", "a_1"}));
  for (const char* plain : {"", "{}", "{1}", "{a b}", "{a,b}", "{", "{ranks", "}ranks{", "{-n}"})
    EXPECT_EQ(names_in_braces(plain), Names{}) << plain;
}

TEST(Substitution, WhatIsPutInIsNotLookedAtAgain) {
  const std::map<std::string, std::string> values{{"a", "{b}"}, {"b", "x y"}};
  EXPECT_EQ(substitute("{a}{b}{c}{a", values), "{b}x y{c}{a");
}

}  // namespace
}  // namespace grouser
