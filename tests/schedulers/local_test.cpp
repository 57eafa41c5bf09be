// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/local.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <sstream>
#include <thread>

#include "base/atomic_file.hpp"
#include "schedulers/process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

class LocalJobs : public ::testing::Test {
 protected:
  JobRequest request(const std::string& name, const std::string& script) const {
    write_atomic(root_.path() / (name + ".sh"), script);
    return {name, root_.path() / (name + ".sh"), root_.path(), root_.path() / (name + ".log")};
  }

  std::optional<JobStatus> ask(const std::string& name) {
    LocalScheduler other(root_.path() / "jobs");  // no state in the process that submitted
    const auto answer = other.query({{name, "", 0.0}});
    EXPECT_TRUE(answer.is_complete);
    if (answer.jobs.empty()) return std::nullopt;
    return answer.jobs.front();
  }

  template <class Condition>
  void wait_for(const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition()) {
      ASSERT_LT(std::chrono::steady_clock::now(), end) << "it does not happen";
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  void wait_for_phase(const std::string& name, JobPhase phase) {
    wait_for([&] {
      const auto status = ask(name);
      return status && status->phase == phase;
    });
  }
  void wait_for_file(const std::string& name) {
    wait_for([&] { return std::filesystem::exists(root_.path() / name); });
  }
  pid_t leader(const std::string& name) const {
    pid_t pid = 0;
    std::istringstream(read_file(root_.path() / "jobs" / name / "started").value()) >> pid;
    return pid;
  }

  TemporaryDirectory root_;
  LocalScheduler scheduler_{root_.path() / "jobs"};
};

TEST_F(LocalJobs, EndWithTheirExitCode) {
  const auto answer = scheduler_.submit(request("good", "echo hello\n"));
  EXPECT_EQ(answer.kind, SubmitAnswer::Kind::kAccepted);
  EXPECT_EQ(answer.job, "good");
  scheduler_.submit(request("bad", "exit 30\n"));
  wait_for_phase("good", JobPhase::kEnded);
  wait_for_phase("bad", JobPhase::kEnded);
  EXPECT_EQ(ask("good")->end, JobEnd::kDone);
  EXPECT_EQ(ask("bad")->end, JobEnd::kFailed);
  EXPECT_EQ(ask("bad")->exit_code, 30);
  EXPECT_EQ(read_file(root_.path() / "good.log"), "hello\n");
}

TEST_F(LocalJobs, AreUnknownUntilTheyHaveStarted) { EXPECT_FALSE(ask("never")); }

TEST_F(LocalJobs, SurviveTheDeathOfTheManager) {
  const auto job = request("orphan", "touch began; until [ -e go ]; do sleep 0.05; done; exit 3\n");
  const pid_t manager = ::fork();
  if (manager == 0) {
    ::setpgid(0, 0);
    LocalScheduler(root_.path() / "jobs").submit(job);
    ::pause();
  }
  wait_for_file("began");
  ::kill(manager, SIGKILL);
  ::waitpid(manager, nullptr, 0);
  ::kill(-manager, SIGKILL);  // whatever is left of the manager's process group
  EXPECT_EQ(ask("orphan")->phase, JobPhase::kRunning);
  write_atomic(root_.path() / "go", "");
  wait_for_phase("orphan", JobPhase::kEnded);
  EXPECT_EQ(ask("orphan")->exit_code, 3);
}

TEST_F(LocalJobs, KilledOutrightAreSeenAsKilled) {
  scheduler_.submit(request("victim", "touch began; sleep 600\n"));
  wait_for_file("began");
  for (const ProcessLine& line : session_processes(leader("victim")))
    ::kill(static_cast<pid_t>(line.pid), SIGKILL);
  wait_for_phase("victim", JobPhase::kEnded);
  EXPECT_EQ(ask("victim")->end, JobEnd::kKilled);
}

TEST_F(LocalJobs, RunAsLongAsAnyOfTheirProcessesDoes) {
  // As MPI launchers do: the rank sits in a process group of its own.
  scheduler_.submit(request("ranks", "set -m; sleep 600 & echo $! >rank; touch began; wait\n"));
  wait_for_file("began");
  ::kill(leader("ranks"), SIGKILL);
  wait_for([&] { return !process_line(leader("ranks")); });
  EXPECT_EQ(ask("ranks")->phase, JobPhase::kRunning);
  EXPECT_EQ(scheduler_.cancel({"ranks", "ranks", 0.0}, CancelMode::kKill), "");
  wait_for_phase("ranks", JobPhase::kEnded);
  EXPECT_EQ(ask("ranks")->end, JobEnd::kKilled);
}

TEST_F(LocalJobs, CancelReachesTheWholeSession) {
  scheduler_.submit(request("many", "set -m; sleep 600 & sleep 600 & touch began; wait\n"));
  wait_for_file("began");
  const pid_t session = leader("many");
  EXPECT_EQ(scheduler_.cancel({"many", "many", 0.0}, CancelMode::kTerminate), "");
  wait_for_phase("many", JobPhase::kEnded);
  EXPECT_TRUE(session_processes(session).empty());
}

TEST_F(LocalJobs, CancelledBeforeTheirStartDoNothing) {
  std::filesystem::create_directories(root_.path() / "jobs" / "late");
  EXPECT_EQ(scheduler_.cancel({"late", "late", 0.0}, CancelMode::kTerminate), "");
  const auto wrapper =
      make_local_wrapper(root_.path() / "jobs" / "late", request("late", "touch \"$0.ran\"\n"));
  write_atomic(root_.path() / "late_wrapper.sh", wrapper);
  EXPECT_NE(std::system(("bash " + (root_.path() / "late_wrapper.sh").string()).c_str()), 0);
  EXPECT_FALSE(std::filesystem::exists(root_.path() / "late.sh.ran"));
  EXPECT_EQ(ask("late")->phase, JobPhase::kEnded);
}

// The number of a long-dead job now belongs to a stranger, who leads a session, too.
TEST_F(LocalJobs, ARecycledNumberIsNotTheJob) {
  const pid_t stranger = ::fork();
  if (stranger == 0) {
    ::setsid();
    ::pause();
  }
  wait_for([&] { return process_line(stranger)->session == stranger; });
  const auto job = root_.path() / "jobs" / "old";
  std::filesystem::create_directories(job);
  write_atomic(job / "started", std::to_string(stranger) + " " +
                                    std::to_string(process_line(stranger)->start - 7) + " " +
                                    boot_id() + " " + host_name() + "\n");
  EXPECT_EQ(ask("old")->end, JobEnd::kKilled);
  EXPECT_EQ(scheduler_.cancel({"old", "old", 0.0}, CancelMode::kKill), "");
  EXPECT_EQ(::waitpid(stranger, nullptr, WNOHANG), 0) << "a stranger was killed";
  ::kill(stranger, SIGKILL);
  ::waitpid(stranger, nullptr, 0);
}

TEST_F(LocalJobs, ARestartOfTheMachineEndsThem) {
  const ProcessId self = this_process();
  const auto job = root_.path() / "jobs" / "before";
  std::filesystem::create_directories(job);
  write_atomic(job / "started", std::to_string(self.pid) + " " + std::to_string(self.start) +
                                    " 11111111-2222-3333-4444-555555555555 " + self.host + "\n");
  EXPECT_EQ(ask("before")->end, JobEnd::kKilled);
}

TEST_F(LocalJobs, OfAnotherHostAreNotJudged) {
  const auto job = root_.path() / "jobs" / "far";
  std::filesystem::create_directories(job);
  write_atomic(job / "started", "1 2 boot elsewhere\n");
  const auto answer = scheduler_.query({{"far", "", 0.0}});
  EXPECT_FALSE(answer.is_complete);
  EXPECT_NE(answer.why_not.find("elsewhere"), std::string::npos);
}

TEST_F(LocalJobs, AreStartedOnceForAName) {
  scheduler_.submit(request("once", "true\n"));
  EXPECT_EQ(scheduler_.submit(request("once", "true\n")).kind, SubmitAnswer::Kind::kUnclear);
}

}  // namespace
}  // namespace grouser
