// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/slurm.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <ctime>
#include <set>

#include "schedulers/command.hpp"
#include "schedulers/text_match.hpp"

namespace grouser {
namespace {

constexpr double kSubmitSeconds = 60.0;
constexpr double kQuerySeconds = 60.0;

struct StateWord {
  const char* word;
  JobPhase phase;
  JobEnd end;
};

constexpr std::array kStates{
    StateWord{"PENDING", JobPhase::kQueued, JobEnd::kNone},
    StateWord{"CONFIGURING", JobPhase::kQueued, JobEnd::kNone},
    StateWord{"REQUEUED", JobPhase::kQueued, JobEnd::kNone},
    StateWord{"REQUEUE_FED", JobPhase::kQueued, JobEnd::kNone},
    StateWord{"REQUEUE_HOLD", JobPhase::kQueued, JobEnd::kNone},
    StateWord{"RESV_DEL_HOLD", JobPhase::kQueued, JobEnd::kNone},
    StateWord{"SPECIAL_EXIT", JobPhase::kQueued, JobEnd::kNone},
    StateWord{"RUNNING", JobPhase::kRunning, JobEnd::kNone},
    StateWord{"COMPLETING", JobPhase::kRunning, JobEnd::kNone},
    StateWord{"RESIZING", JobPhase::kRunning, JobEnd::kNone},
    StateWord{"SIGNALING", JobPhase::kRunning, JobEnd::kNone},
    StateWord{"STAGE_OUT", JobPhase::kRunning, JobEnd::kNone},
    StateWord{"STOPPED", JobPhase::kRunning, JobEnd::kNone},
    StateWord{"SUSPENDED", JobPhase::kRunning, JobEnd::kNone},
    StateWord{"COMPLETED", JobPhase::kEnded, JobEnd::kDone},
    StateWord{"FAILED", JobPhase::kEnded, JobEnd::kFailed},
    StateWord{"CANCELLED", JobPhase::kEnded, JobEnd::kCancelled},
    StateWord{"REVOKED", JobPhase::kEnded, JobEnd::kCancelled},
    StateWord{"TIMEOUT", JobPhase::kEnded, JobEnd::kTimeout},
    StateWord{"DEADLINE", JobPhase::kEnded, JobEnd::kTimeout},
    StateWord{"NODE_FAIL", JobPhase::kEnded, JobEnd::kNodeFailed},
    StateWord{"BOOT_FAIL", JobPhase::kEnded, JobEnd::kNodeFailed},
    StateWord{"PREEMPTED", JobPhase::kEnded, JobEnd::kPreempted},
    StateWord{"OUT_OF_MEMORY", JobPhase::kEnded, JobEnd::kOutOfMemory},
};

const StateWord* state_word(const std::string& text) {
  // "CANCELLED by 1001": the first word is the state.
  const std::string word = text.substr(0, text.find(' '));
  for (const StateWord& state : kStates)
    if (word == state.word) return &state;
  return nullptr;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

// "7:0" -> 7, "0:9" -> 128 + 9.
std::optional<int> exit_code_of(const std::string& text) {
  int code = 0;
  int signal_number = 0;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, code);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != ':') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, signal_number);
  if (second.ec != std::errc() || second.ptr != end) return std::nullopt;
  return signal_number > 0 ? 128 + signal_number : code;
}

// "123", or "123_4" for a task of an array.
bool is_job_id(const std::string& text) {
  const auto at = text.find('_');
  return is_number(text.substr(0, at)) &&
         (at == std::string::npos || is_number(text.substr(at + 1)));
}

// Four fields, a job's id, a known state; the caller reads the fourth. Tasks of an array share
// their name, so their index is put behind it.
std::optional<JobStatus> parse_line(const std::string& line, std::string& fourth) {
  auto parts = cut(line, '|');
  if (parts.size() != 4 || !is_job_id(parts[0])) return std::nullopt;
  if (const auto at = parts[0].find('_'); at != std::string::npos) parts[1] += parts[0].substr(at);
  const StateWord* state = state_word(parts[2]);
  if (state == nullptr) return std::nullopt;
  fourth = parts[3];
  JobStatus status{parts[1], parts[0], state->phase, state->end, -1, parts[2]};
  // "CANCELLED by 0": an administrator clears a node; "by" ourselves: a person's own wish.
  const std::string by = "CANCELLED by ";
  if (parts[2].starts_with(by) && parts[2] != by + std::to_string(::getuid()))
    status.end = JobEnd::kDrained;
  return status;
}

bool is_without_accounting(const std::string& message) {
  return contains_any(message, {"accounting storage is disabled", "slurmdbd is not configured"});
}

std::string failure_text(const std::string& program, const CommandResult& result) {
  if (result.timed_out) return program + " took too long";
  return program + ": " + one_line(result.err.empty() ? result.out : result.err);
}

// A day more than needed: sacct's window counts in the cluster's time, and clocks differ.
std::string window_start(const std::vector<JobKey>& jobs) {
  double earliest = jobs.front().submitted_at;
  for (const JobKey& job : jobs) earliest = std::min(earliest, job.submitted_at);
  const auto seconds = static_cast<std::time_t>(earliest - 86400.0);
  std::tm day{};
  ::localtime_r(&seconds, &day);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &day);
  return text.data();
}

// All our jobs when the names would be too long for a command line (128 KiB for one argument).
std::string name_filter(const std::set<std::string>& names) {
  constexpr std::size_t kMostNames = 4000;
  if (names.size() > kMostNames) return "--user=" + std::to_string(::getuid());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ",") + name;
  return "--name=" + list;
}

// Adds those of `found` that are asked for and not yet answered.
void add_asked(const std::vector<JobStatus>& found, std::set<std::string>& open,
               QueryAnswer& answer) {
  for (const JobStatus& status : found)
    if (open.erase(status.name) > 0) answer.jobs.push_back(status);
}

}  // namespace

std::optional<std::string> parse_sbatch(const std::string& out) {
  // Site plug-ins may print lines of their own before it.
  const auto lines = lines_of(out);
  if (lines.empty()) return std::nullopt;
  const std::string id = lines.back().substr(0, lines.back().find(';'));
  if (!is_number(id)) return std::nullopt;
  return id;
}

SubmitAnswer::Kind judge_sbatch_failure(const std::string& message) {
  // The controller may have taken the job although the answer did not come back.
  if (contains_any(message, {"timed out", "Zero Bytes", "Unexpected message", "Transport endpoint",
                             "Communication connection failure"}))
    return SubmitAnswer::Kind::kUnclear;
  if (contains_any(message, {"Unable to contact slurm controller", "Connection refused",
                             "SubmitJobLimit", "MaxSubmitJob", "temporarily unable",
                             "Resource temporarily unavailable", "SlurmctldHost"}))
    return SubmitAnswer::Kind::kBusy;
  return SubmitAnswer::Kind::kRefused;
}

std::optional<std::vector<JobStatus>> parse_squeue(const std::string& out) {
  std::vector<JobStatus> jobs;
  for (const std::string& line : lines_of(out)) {
    std::string reason;
    auto status = parse_line(line, reason);
    if (!status) return std::nullopt;
    if (!reason.empty() && reason != "None") status->detail += " (" + reason + ")";
    jobs.push_back(*status);
  }
  return jobs;
}

std::optional<std::vector<JobStatus>> parse_sacct(const std::string& out) {
  std::vector<JobStatus> jobs;
  for (const std::string& line : lines_of(out)) {
    // "123_[4-7%2]": tasks that wait, which the queue knows.
    if (line.find("_[") < line.find('|')) continue;
    std::string code;
    auto status = parse_line(line, code);
    const auto number = exit_code_of(code);
    if (!status || !number) return std::nullopt;
    if (status->phase == JobPhase::kEnded) status->exit_code = *number;
    // COMPLETED says that the batch script ended; only its code says how.
    if (status->end == JobEnd::kDone && *number != 0) status->end = JobEnd::kFailed;
    if (status->end == JobEnd::kFailed && *number > 128) status->end = JobEnd::kKilled;
    jobs.push_back(*status);
  }
  return jobs;
}

SubmitAnswer SlurmScheduler::submit(const JobRequest& request) {
  const auto result =
      run_command({"sbatch", "--parsable", "--chdir=" + request.work_directory.string(),
                   request.script.string()},
                  kSubmitSeconds, request.work_directory);
  if (!result.started) return {SubmitAnswer::Kind::kRefused, "", result.err};
  if (result.timed_out) return {SubmitAnswer::Kind::kUnclear, "", failure_text("sbatch", result)};
  if (result.code != 0)
    return {judge_sbatch_failure(result.err + result.out), "", failure_text("sbatch", result)};
  const auto id = parse_sbatch(result.out);
  if (!id)
    return {SubmitAnswer::Kind::kUnclear, "", "sbatch printed no job id: " + one_line(result.out)};
  return {SubmitAnswer::Kind::kAccepted, *id, ""};
}

QueryAnswer SlurmScheduler::query(const std::vector<JobKey>& jobs) {
  QueryAnswer answer;
  answer.is_complete = true;
  if (jobs.empty()) return answer;
  std::set<std::string> shared;
  std::set<std::string> open;
  for (const JobKey& job : jobs) {
    shared.insert(job.name.substr(0, job.name.find('_')));
    open.insert(job.name);
  }
  const std::string whose = name_filter(shared);
  const auto refuse = [&](const std::string& why) {
    answer.is_complete = false;
    answer.why_not = why;
    return answer;
  };
  // While the queue has the job it knows best; accounting may still show an earlier life of it.
  const auto queue = run_command(
      {"squeue", "--noheader", "--array", whose, "--states=all", "--format=%i|%j|%T|%r"},
      kQuerySeconds);
  if (!queue.started) return refuse(queue.err);
  const auto queued = parse_squeue(queue.out);
  if (queue.timed_out || queue.code != 0 || !queued) return refuse(failure_text("squeue", queue));
  // Ended jobs linger in the queue without their exit code: those are asked of accounting.
  std::vector<JobStatus> ended_in_queue;
  std::vector<JobStatus> alive;
  for (const JobStatus& status : *queued)
    (status.phase == JobPhase::kEnded ? ended_in_queue : alive).push_back(status);
  add_asked(alive, open, answer);
  if (open.empty()) return answer;
  const auto books =
      run_command({"sacct", "--noheader", "--parsable2", "--allocations", whose,
                   "--starttime=" + window_start(jobs), "--format=JobID,JobName,State,ExitCode"},
                  kQuerySeconds);
  const auto booked = parse_sacct(books.out);
  const bool is_readable = books.started && !books.timed_out && books.code == 0 && booked;
  if (is_readable) add_asked(*booked, open, answer);
  add_asked(ended_in_queue, open, answer);
  if (is_readable || is_without_accounting(books.err)) return answer;
  return refuse(failure_text("sacct", books));
}

std::string SlurmScheduler::cancel(const JobKey& job, CancelMode mode) {
  std::vector<std::string> words{"scancel"};
  if (mode == CancelMode::kKill) words.insert(words.end(), {"--full", "--signal=KILL"});
  // The name of an array's task is that of the whole array.
  if (job.id.empty() && job.name.find('_') != std::string::npos)
    return job.name + ": its id is not known yet; the next tick looks for it";
  words.push_back(job.id.empty() ? "--name=" + job.name : job.id);
  const auto result = run_command(words, kQuerySeconds);
  if (!result.started) return result.err;
  if (result.timed_out || result.code != 0) return failure_text("scancel", result);
  return "";
}

}  // namespace grouser
