// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/pbs.hpp"

#include <algorithm>
#include <charconv>
#include <map>

#include "schedulers/command.hpp"
#include "schedulers/scripts.hpp"
#include "schedulers/text_match.hpp"

namespace grouser {
namespace {

constexpr double kSubmitSeconds = 60.0;
constexpr double kQuerySeconds = 60.0;

using Attributes = std::map<std::string, std::string>;

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// How a finished job ended, from PBS's exit status: below 0 PBS itself ended it, from 256 a signal
// to the job's first process, from 128 a child's signal as the shell reports it.
JobEnd end_of(int status) {
  switch (status) {
    case 0:
      return JobEnd::kDone;
    case -29:
      return JobEnd::kTimeout;
    case -26:
    case -27:
      return JobEnd::kOutOfMemory;
    case 256 + 15:
    case 256 + 9:
      return JobEnd::kKilled;
    default:
      break;
  }
  if (status < 0) return JobEnd::kNodeFailed;
  return status > 128 ? JobEnd::kKilled : JobEnd::kFailed;
}

std::optional<JobStatus> finished_status(JobStatus job, const Attributes& attributes) {
  job.phase = JobPhase::kEnded;
  const auto status = attributes.find("Exit_status");
  if (status == attributes.end()) {
    // Deleted before it ran.
    job.end = JobEnd::kCancelled;
    return job;
  }
  int code = 0;
  const char* const end = status->second.data() + status->second.size();
  const auto [rest, error] = std::from_chars(status->second.data(), end, code);
  if (error != std::errc() || rest != end) return std::nullopt;
  job.end = end_of(code);
  job.exit_code = code > 256 ? 128 + (code - 256) : code;
  const auto comment = attributes.find("comment");
  if (comment != attributes.end()) {
    job.detail += " (" + comment->second + ")";
    if (contains_any(comment->second, {"exceeded resource walltime"})) job.end = JobEnd::kTimeout;
  }
  return job;
}

std::optional<JobStatus> status_of(const std::string& id, const Attributes& attributes) {
  const auto name = attributes.find("Job_Name");
  const auto state = attributes.find("job_state");
  if (name == attributes.end() || state == attributes.end() || state->second.size() != 1)
    return std::nullopt;
  JobStatus job{name->second, id, JobPhase::kQueued, JobEnd::kNone, -1, state->second};
  const char letter = state->second[0];
  if (std::string("QHWTMU").find(letter) != std::string::npos) return job;
  job.phase = JobPhase::kRunning;
  if (std::string("REBS").find(letter) != std::string::npos) return job;
  if (letter == 'F' || letter == 'C' || letter == 'X') return finished_status(job, attributes);
  return std::nullopt;
}

std::string failure_text(const std::string& program, const CommandResult& result) {
  if (result.timed_out) return program + " took too long";
  return program + ": " + one_line(result.err.empty() ? result.out : result.err);
}

bool is_without_history(const std::string& message) {
  return contains_any(message, {"job history", "history not", "not configured"});
}

// Asks with finished jobs included, and without them where the server keeps none.
CommandResult ask(const std::string& program, const std::vector<std::string>& words) {
  std::vector<std::string> all{program, "-x"};
  all.insert(all.end(), words.begin(), words.end());
  auto result = run_command(all, kQuerySeconds);
  if (!result.started || result.timed_out || result.code == 0 || !is_without_history(result.err))
    return result;
  all.erase(all.begin() + 1);
  return run_command(all, kQuerySeconds);
}

// Ids of the jobs of that name, or nothing when the server cannot be asked.
std::optional<std::vector<std::string>> select_by_name(const std::string& name, std::string& why) {
  const auto result = ask("qselect", {"-N", name});
  if (!result.started || result.timed_out || result.code != 0) {
    why = result.started ? failure_text("qselect", result) : result.err;
    return std::nullopt;
  }
  std::vector<std::string> ids;
  for (const std::string& line : lines_of(result.out)) {
    const auto id = parse_qsub(line);
    if (!id) {
      why = "qselect printed no job id: " + one_line(result.out);
      return std::nullopt;
    }
    ids.push_back(*id);
  }
  return ids;
}

}  // namespace

std::optional<std::string> parse_qsub(const std::string& out) {
  const auto lines = lines_of(out);
  if (lines.empty()) return std::nullopt;
  const std::string id = trimmed(lines.back());
  const auto digits = id.find_first_not_of("0123456789");
  if (digits == 0 || id.find_first_of(" \t") != std::string::npos) return std::nullopt;
  if (digits != std::string::npos && id[digits] != '.') return std::nullopt;
  return id;
}

std::optional<std::vector<JobStatus>> parse_qstat(const std::string& out) {
  std::vector<std::pair<std::string, Attributes>> found;
  std::string* last_value = nullptr;
  for (const std::string& line : lines_of(out)) {
    if (line.rfind("Job Id:", 0) == 0) {
      found.emplace_back(trimmed(line.substr(7)), Attributes{});
      last_value = nullptr;
    } else if (line[0] == '\t' && last_value != nullptr) {
      *last_value += trimmed(line);  // a long value goes on
    } else {
      const auto equals = line.find(" = ");
      if (found.empty() || equals == std::string::npos) return std::nullopt;
      last_value = &found.back().second[trimmed(line.substr(0, equals))];
      *last_value = trimmed(line.substr(equals + 3));
    }
  }
  std::vector<JobStatus> jobs;
  for (const auto& [id, attributes] : found) {
    const auto status = status_of(id, attributes);
    if (!status) return std::nullopt;
    jobs.push_back(*status);
  }
  return jobs;
}

bool is_only_unknown_jobs(const std::string& err) {
  const auto lines = lines_of(err);
  return !lines.empty() && std::all_of(lines.begin(), lines.end(), [](const std::string& line) {
    return contains_any(line, {"Unknown Job Id", "Job has finished"});
  });
}

SubmitAnswer PbsScheduler::submit(const JobRequest& request) {
  const auto result =
      run_command({"qsub", "-o", attempt_files::kDirectory, request.script.string()},
                  kSubmitSeconds, request.work_directory);
  if (!result.started) return {SubmitAnswer::Kind::kRefused, "", result.err};
  if (result.timed_out) return {SubmitAnswer::Kind::kUnclear, "", failure_text("qsub", result)};
  if (result.code != 0) {
    const std::string message = failure_text("qsub", result);
    if (contains_any(message, {"cannot connect", "Connection refused", "would exceed", "max_queued",
                               "Maximum number of jobs"}))
      return {SubmitAnswer::Kind::kBusy, "", message};
    if (contains_any(message, {"timed out", "timeout", "End of File", "Protocol"}))
      return {SubmitAnswer::Kind::kUnclear, "", message};
    return {SubmitAnswer::Kind::kRefused, "", message};
  }
  const auto id = parse_qsub(result.out);
  if (!id)
    return {SubmitAnswer::Kind::kUnclear, "", "qsub printed no job id: " + one_line(result.out)};
  return {SubmitAnswer::Kind::kAccepted, *id, ""};
}

QueryAnswer PbsScheduler::query(const std::vector<JobKey>& jobs) {
  QueryAnswer answer;
  answer.is_complete = true;
  const auto refuse = [&](const std::string& why) {
    answer.is_complete = false;
    answer.why_not = why;
    return answer;
  };
  std::vector<std::string> words{"-f"};
  for (const JobKey& job : jobs) {
    if (!job.id.empty()) {
      words.push_back(job.id);
      continue;
    }
    std::string why;
    const auto ids = select_by_name(job.name, why);
    if (!ids) return refuse(why);
    words.insert(words.end(), ids->begin(), ids->end());
  }
  if (words.size() == 1) return answer;
  const auto result = ask("qstat", words);
  if (!result.started) return refuse(result.err);
  const auto found = parse_qstat(result.out);
  if (result.timed_out || !found || (result.code != 0 && !is_only_unknown_jobs(result.err)))
    return refuse(failure_text("qstat", result));
  for (const JobStatus& status : *found)
    for (const JobKey& job : jobs)
      if (job.name == status.name) answer.jobs.push_back(status);
  return answer;
}

std::string PbsScheduler::cancel(const JobKey& job, CancelMode mode) {
  std::vector<std::string> ids;
  if (job.id.empty()) {
    std::string why;
    const auto found = select_by_name(job.name, why);
    if (!found) return why;
    ids = *found;
  } else {
    ids.push_back(job.id);
  }
  if (ids.empty()) return "";
  std::vector<std::string> words{"qdel"};
  if (mode == CancelMode::kKill) words.insert(words.end(), {"-W", "force"});
  words.insert(words.end(), ids.begin(), ids.end());
  const auto result = run_command(words, kQuerySeconds);
  if (!result.started) return result.err;
  if (result.timed_out || (result.code != 0 && !is_only_unknown_jobs(result.err)))
    return failure_text("qdel", result);
  return "";
}

}  // namespace grouser
