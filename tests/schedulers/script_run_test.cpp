// SPDX-License-Identifier: BSD-3-Clause
// Runs the job scripts themselves, with small shell programs in place of the engine.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "base/atomic_file.hpp"
#include "schedulers/command.hpp"
#include "schedulers/scripts.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

class ScriptRun : public ::testing::Test {
 protected:
  // A script whose engine is `bash -c PROGRAM`, in a directory whose name needs quoting.
  std::filesystem::path write_script(const std::string& program) {
    spec_.token = "abc123def456";
    spec_.run_directory = directory_.path() / "it's a \"run\" $HOME";
    std::filesystem::create_directories(spec_.run_directory / attempt_files::kDirectory);
    write_atomic(spec_.run_directory / "fence", spec_.token);
    spec_.engine = {"bash", "-c", program};
    const auto file = spec_.run_directory / attempt_files::script(spec_.token);
    write_atomic(file, make_local_script(spec_));
    return file;
  }
  std::optional<JobRecord> record(const std::string& name) const {
    const auto text = read_file(spec_.run_directory / name);
    if (!text) return std::nullopt;
    return job_record_from_json(*text, name);
  }

  TemporaryDirectory directory_;
  JobSpec spec_;
};

TEST_F(ScriptRun, LeavesRecordsOfItsStartAndEnd) {
  const auto script = write_script("exit 10");
  EXPECT_EQ(run_command({"bash", script.string()}, 20.0).code, 10);
  ASSERT_TRUE(record(attempt_files::started(spec_.token)));
  const auto exit = record(attempt_files::exit(spec_.token));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 10);
  EXPECT_EQ(exit->token, spec_.token);
}

TEST_F(ScriptRun, LeavesAtOnceWhenTheFenceNamesAnother) {
  const auto script = write_script("touch engine_ran");
  write_atomic(spec_.run_directory / "fence", "zzz999zzz999");
  EXPECT_EQ(run_command({"bash", script.string()}, 20.0).code, 22);
  EXPECT_FALSE(std::filesystem::exists(spec_.run_directory / "engine_ran"));
  EXPECT_FALSE(record(attempt_files::started(spec_.token)));
}

// Scenario 18: the batch system starts the job over under its own id while its first life, on a
// node that was lost, is still at work.
TEST_F(ScriptRun, S18ASecondLifeClaimsTheRunAndTheFirstLeavesNoWord) {
  const auto script =
      write_script("[ -e second ] || { touch second; bash attempts/abc123def456.sh; }; cat fence");
  const auto first = run_command({"bash", script.string()}, 20.0);
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(read_file(spec_.run_directory / "fence"), "abc123def456 1");
  const auto exit = spec_.run_directory / attempt_files::exit(spec_.token);
  ASSERT_TRUE(std::filesystem::exists(exit));  // of the second life
  std::filesystem::remove(exit);
  std::filesystem::remove(spec_.run_directory / "second");
  write_atomic(spec_.run_directory / "fence", "zzz999zzz999");
  EXPECT_EQ(run_command({"bash", script.string()}, 20.0).code, 22);
  EXPECT_FALSE(std::filesystem::exists(exit));
}

TEST_F(ScriptRun, ReportsAnEngineThatIsMissing) {
  write_script("");
  spec_.engine = {"/no/such/engine"};
  const auto file = spec_.run_directory / attempt_files::script(spec_.token);
  write_atomic(file, make_local_script(spec_));
  EXPECT_EQ(run_command({"bash", file.string()}, 20.0).code, 127);
  EXPECT_EQ(record(attempt_files::exit(spec_.token))->code, 127);
}

// A batch system sends USR1 ahead of the limit, or TERM at it: the engine must get its stop file
// and the script must wait for it, however often the signal comes.
TEST_F(ScriptRun, TurnsSignalsIntoTheStopFileAndWaits) {
  const auto script = write_script(
      "trap '' TERM; touch ready; until [ -e stop ]; do sleep 0.05; done; sleep 0.3; exit 12");
  const pid_t child = ::fork();
  if (child == 0) {
    ::execlp("bash", "bash", script.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  while (!std::filesystem::exists(spec_.run_directory / "ready"))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(child, SIGUSR1);
  while (!std::filesystem::exists(spec_.run_directory / "stop"))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(child, SIGTERM);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 12);
  EXPECT_EQ(record(attempt_files::exit(spec_.token))->code, 12);
  EXPECT_EQ(read_file(spec_.run_directory / "stop"), "signal\n");
}

// A job that lost its run must not stop the attempt that owns it now.
TEST_F(ScriptRun, StopsNobodyElse) {
  const auto script = write_script("touch ready; until [ -e go ]; do sleep 0.05; done");
  const pid_t child = ::fork();
  if (child == 0) {
    ::execlp("bash", "bash", script.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  while (!std::filesystem::exists(spec_.run_directory / "ready"))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  write_atomic(spec_.run_directory / "fence", "zzz999zzz999");
  ::kill(child, SIGTERM);
  write_atomic(spec_.run_directory / "go", "");
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_FALSE(std::filesystem::exists(spec_.run_directory / "stop"));
}

}  // namespace
}  // namespace grouser
