// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/local.hpp"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <thread>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "schedulers/shell.hpp"

namespace grouser {
namespace {

constexpr const char* kStarted = "started";
constexpr const char* kExit = "exit";
constexpr const char* kCancelled = "cancelled";
constexpr const char* kWrapper = "wrapper.sh";

constexpr const char* kWrapperText = R"sh(#!/bin/bash
export GROUSER_JOB=@NAME@
job=@JOB@
script=@SCRIPT@
put() {
  printf '%s\n' "$2" >"$job/.$1.tmp" && mv -f "$job/.$1.tmp" "$job/$1"
}

# Field 22 of stat is the start time; counted from the end of the name, which may hold blanks.
stat=$(cat /proc/$$/stat)
fields=(${stat##*) })
put started "$$ ${fields[19]} $(cat /proc/sys/kernel/random/boot_id) $(uname -n)"
if [ -e "$job/cancelled" ]; then
  put exit 143
  exit 143
fi
trap : TERM USR1 HUP INT
bash "$script" &
child=$!
code=127
while kill -0 "$child" 2>/dev/null; do
  wait "$child"
  code=$?
done
wait "$child" 2>/dev/null
last=$?
[ "$last" -eq 127 ] || code=$last
put exit "$code"
)sh";

// Leader of a new session with nothing of the manager's left but its environment.
[[noreturn]] void become_job(const char* wrapper, const char* log, const char* directory) {
  ::setsid();
  const int nothing = ::open("/dev/null", O_RDONLY);
  const int out = ::open(log, O_WRONLY | O_CREAT | O_APPEND, 0666);
  if (nothing < 0 || out < 0 || ::dup2(nothing, 0) < 0 || ::dup2(out, 1) < 0 ||
      ::dup2(out, 2) < 0 || ::chdir(directory) != 0)
    ::_exit(127);
  ::close_range(3, ~0U, 0);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  // A shell cannot trap what it was told to ignore.
  for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGPIPE, SIGQUIT})
    ::signal(number, SIG_DFL);
  ::execl("/bin/bash", "bash", wrapper, static_cast<char*>(nullptr));
  ::_exit(127);
}

// Forks twice: the job is nobody's child, so it outlives the manager and leaves no zombie.
bool start_detached(const std::string& wrapper, const std::string& log,
                    const std::string& directory) {
  const pid_t middle = ::fork();
  if (middle < 0) return false;
  if (middle == 0) {
    const pid_t job = ::fork();
    if (job == 0) become_job(wrapper.c_str(), log.c_str(), directory.c_str());
    ::_exit(job < 0 ? 1 : 0);
  }
  int status = 0;
  while (::waitpid(middle, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// Processes of the job. When the leader is gone its number may lead a stranger's session; a process
// without a leader is ours only if it was born with our name.
std::vector<ProcessLine> job_processes(const ProcessId& leader, const std::string& name) {
  const auto at_number = process_line(leader.pid);
  if (at_number && at_number->start != leader.start) return {};
  std::vector<ProcessLine> members = session_processes(leader.pid);
  if (at_number && at_number->state != 'Z') return members;
  std::erase_if(members, [&](const ProcessLine& line) {
    return !has_environment(line.pid, "GROUSER_JOB=" + name);
  });
  return members;
}

JobStatus ended(JobStatus status, JobEnd end, int code, const std::string& detail) {
  status.phase = JobPhase::kEnded;
  status.end = end;
  status.exit_code = code;
  status.detail = detail;
  return status;
}

JobStatus status_of(const ProcessId& leader, const std::string& name,
                    const std::optional<std::string>& exit_record) {
  JobStatus status;
  status.name = name;
  status.id = name;
  status.phase = JobPhase::kRunning;
  status.detail = "pid " + std::to_string(leader.pid);
  if (leader.boot != boot_id()) return ended(status, JobEnd::kKilled, -1, "the machine restarted");
  // The usual case, told without a walk through the whole process table.
  const auto at_number = process_line(leader.pid);
  if (at_number && at_number->start == leader.start && at_number->state != 'Z') return status;
  if (!job_processes(leader, name).empty()) return status;
  if (!exit_record) return ended(status, JobEnd::kKilled, -1, "killed");
  int code = -1;
  std::istringstream(*exit_record) >> code;
  // The shell around the engine may live long enough to report the signal that killed it.
  const JobEnd end = code == 0 ? JobEnd::kDone : code > 128 ? JobEnd::kKilled : JobEnd::kFailed;
  return ended(status, end, code, "exit code " + std::to_string(code));
}

}  // namespace

LocalScheduler::LocalScheduler(std::filesystem::path jobs_directory)
    : jobs_(std::move(jobs_directory)) {}

std::string make_local_wrapper(const std::filesystem::path& job_directory,
                               const JobRequest& request) {
  return fill(kWrapperText, {{"NAME", shell_quote(request.name)},
                             {"JOB", shell_quote(job_directory.string())},
                             {"SCRIPT", shell_quote(request.script.string())}});
}

SubmitAnswer LocalScheduler::submit(const JobRequest& request) {
  const std::filesystem::path directory = jobs_ / request.name;
  std::filesystem::create_directories(jobs_);
  if (!std::filesystem::create_directory(directory))
    return {SubmitAnswer::Kind::kUnclear, "", "a job of this name was started before"};
  const std::filesystem::path wrapper = directory / kWrapper;
  write_atomic(wrapper, make_local_wrapper(directory, request));
  if (!start_detached(wrapper.string(), request.log.string(), request.work_directory.string()))
    return {SubmitAnswer::Kind::kBusy, "",
            std::string("cannot start a process: ") + std::strerror(errno)};
  return {SubmitAnswer::Kind::kAccepted, request.name, ""};
}

std::optional<ProcessId> LocalScheduler::leader(const std::string& name) const {
  const auto text = read_file(jobs_ / name / kStarted);
  if (!text) return std::nullopt;
  ProcessId id;
  std::istringstream(*text) >> id.pid >> id.start >> id.boot >> id.host;
  if (id.pid <= 0 || id.host.empty())
    throw FormatError((jobs_ / name / kStarted).string() + ": not a record of a started job");
  return id;
}

QueryAnswer LocalScheduler::query(const std::vector<JobKey>& jobs) {
  QueryAnswer answer;
  answer.is_complete = true;
  for (const JobKey& job : jobs) {
    const auto process = leader(job.name);
    if (!process) continue;
    if (process->host != host_name()) {
      answer.is_complete = false;
      answer.why_not = "job " + job.name + " runs on host " + process->host +
                       "; only a manager there can see it";
      continue;
    }
    // The exit record is read before the processes are counted: in the other order a job that
    // ends in between would look killed.
    const auto before = read_file(jobs_ / job.name / kExit);
    JobStatus status = status_of(*process, job.name, before);
    if (status.phase == JobPhase::kEnded && !before)
      status = status_of(*process, job.name, read_file(jobs_ / job.name / kExit));
    answer.jobs.push_back(status);
  }
  return answer;
}

std::string LocalScheduler::cancel(const JobKey& job, CancelMode mode) {
  const std::filesystem::path directory = jobs_ / job.name;
  if (!std::filesystem::is_directory(directory)) return "no job of this name was started here";
  create_exclusive(directory / kCancelled, "");
  const auto process = leader(job.name);
  if (!process) return "";
  if (process->host != host_name()) return "the job runs on host " + process->host;
  if (process->boot != boot_id()) return "";
  const int signal_number = mode == CancelMode::kKill ? SIGKILL : SIGTERM;
  // mpirun puts ranks into process groups of their own; the session holds them all.
  for (const ProcessLine& line : job_processes(*process, job.name))
    ::kill(static_cast<pid_t>(line.pid), signal_number);
  return "";
}

int available_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace grouser
