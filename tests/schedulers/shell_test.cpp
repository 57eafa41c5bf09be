// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/shell.hpp"

#include <gtest/gtest.h>

#include <random>

#include "schedulers/command.hpp"

namespace grouser {
namespace {

TEST(Shell, QuotedWordsArriveAsTheyAre) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(1, 255);
  std::uniform_int_distribution<int> length(0, 40);
  const std::string nasty = "'\"\\$`!*?[]{}()<>|&;#~ \t\n-%=";
  std::string expected;
  std::vector<std::string> words{"printf", "%s\\001"};
  for (int i = 0; i < 2000; ++i) {
    std::string word;
    for (int k = length(random); k > 0; --k) {
      const auto pick = static_cast<std::size_t>(any(random));
      const char c = i % 2 == 0 ? nasty[pick % nasty.size()] : static_cast<char>(pick);
      word += c == '\001' ? 'x' : c;
    }
    words.push_back(word);
    expected += word + "\001";
  }
  for (const char* shell : {"bash", "dash"}) {
    const auto result = run_command({shell, "-c", shell_join(words)}, 30.0);
    EXPECT_EQ(result.out, expected) << shell << ", seed " << seed;
  }
}

TEST(Shell, ANulCannotBeQuoted) {
  EXPECT_THROW(shell_quote(std::string("a\0b", 3)), std::invalid_argument);
}

TEST(Shell, FilledInTextIsNotFilledAgain) {
  EXPECT_EQ(fill("a @X@ @Y@ b@c @Z@", {{"X", "@Y@"}, {"Y", "y"}}), "a @Y@ y b@c @Z@");
  EXPECT_EQ(fill("@@X@", {{"X", "1"}}), "@1");
}

TEST(Shell, WordsAreSplitAtBlanksOnly) {
  EXPECT_EQ(split_words("  srun --mpi=pmix  'a "),
            (std::vector<std::string>{"srun", "--mpi=pmix", "'a"}));
}

}  // namespace
}  // namespace grouser
