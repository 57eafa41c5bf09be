// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/process.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace grouser {
namespace {

TEST(Process, ThisOneIsAlive) {
  const ProcessId self = this_process();
  EXPECT_EQ(self.pid, ::getpid());
  EXPECT_GT(self.start, 0);
  EXPECT_EQ(is_alive(self), true);
}

TEST(Process, ARecycledNumberIsNotTheProcess) {
  ProcessId other = this_process();
  other.start -= 1;
  EXPECT_EQ(is_alive(other), false);
}

TEST(Process, NothingSurvivesARestartOfTheMachine) {
  ProcessId other = this_process();
  other.boot = "00000000-0000-0000-0000-000000000000";
  EXPECT_EQ(is_alive(other), false);
}

TEST(Process, OfAnotherHostNothingIsKnown) {
  ProcessId other = this_process();
  other.host += "-other";
  EXPECT_EQ(is_alive(other), std::nullopt);
}

TEST(Process, AZombieIsNotAlive) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ProcessId id = this_process();
  // Waits for the end without taking the child away.
  siginfo_t info{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT), 0);
  const auto line = process_line(child);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->state, 'Z');
  id.pid = child;
  id.start = line->start;
  EXPECT_EQ(is_alive(id), false);
  ::waitpid(child, nullptr, 0);
}

}  // namespace
}  // namespace grouser
