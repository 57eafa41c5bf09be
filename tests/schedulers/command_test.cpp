// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/command.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace grouser {
namespace {

TEST(Command, GivesOutputErrorsAndExitCode) {
  const auto result = run_command({"sh", "-c", "echo out; echo err >&2; exit 7"}, 10.0);
  EXPECT_TRUE(result.started);
  EXPECT_EQ(result.code, 7);
  EXPECT_EQ(result.out, "out\n");
  EXPECT_EQ(result.err, "err\n");
}

TEST(Command, ArgumentsReachTheProgramUnchanged) {
  const auto result = run_command({"printf", "%s|", "a b", "$HOME", "'\"\\", "*"}, 10.0);
  EXPECT_EQ(result.out, "a b|$HOME|'\"\\|*|");
}

TEST(Command, AMissingProgramIsNotStarted) {
  const auto result = run_command({"grouser-no-such-program"}, 10.0);
  EXPECT_FALSE(result.started);
  EXPECT_NE(result.err.find("grouser-no-such-program"), std::string::npos);
}

TEST(Command, ASlowProgramIsKilledAndSaidToHaveTimedOut) {
  const auto start = std::chrono::steady_clock::now();
  const auto result = run_command({"sh", "-c", "echo before; sleep 60"}, 0.3);
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.out, "before\n");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Command, MuchOutputOnBothStreamsDoesNotBlock) {
  const auto result =
      run_command({"sh", "-c", "head -c 3000000 /dev/zero >&2; head -c 3000000 /dev/zero"}, 60.0);
  EXPECT_EQ(result.out.size(), 3000000u);
  EXPECT_EQ(result.err.size(), 3000000u);
}

TEST(Command, ASignalShowsAs128PlusItsNumber) {
  EXPECT_EQ(run_command({"sh", "-c", "kill -9 $$"}, 10.0).code, 137);
}

}  // namespace
}  // namespace grouser
