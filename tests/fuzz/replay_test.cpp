// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>

#include "base/atomic_file.hpp"
#include "targets.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

class Corpus : public testing::TestWithParam<FuzzTarget> {};

// What a fuzzer found once, and what it starts from.
TEST_P(Corpus, IsReadOrRefused) {
  const fs::path folder = fs::path(FUZZ_CORPUS) / GetParam().name;
  int files = 0;
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    GetParam().read(read_file(entry.path()).value());
    bytes += entry.file_size();
    ++files;
  }
  EXPECT_GT(files, 0);
  EXPECT_LT(bytes, 64u << 10) << "corpora are kept small";
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, testing::ValuesIn(kFuzzTargets),
                         [](const auto& one) { return std::string(one.param.name); });

// Whole, in halves, and with a byte of every kind at every tenth place.
TEST_P(Corpus, IsReadOrRefusedWhenItIsDamaged) {
  for (const auto& entry : fs::directory_iterator(fs::path(FUZZ_CORPUS) / GetParam().name)) {
    const std::string text = read_file(entry.path()).value();
    for (std::size_t at = 0; at < text.size(); at += text.size() / 20 + 1) {
      GetParam().read(text.substr(0, at));
      for (const char c : {'\0', '\n', '"', '{', ':', '\x80', '9', '|', '-'}) {
        std::string damaged = text;
        damaged[at] = c;
        GetParam().read(damaged);
      }
    }
  }
}

}  // namespace
}  // namespace grouser
