// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/submit.hpp"

#include <algorithm>
#include <random>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/run_contract.hpp"
#include "base/units.hpp"
#include "campaign/drive/decide.hpp"
#include "campaign/drive/fault.hpp"

namespace grouser {
namespace {

// Scripts of job arrays, in the campaign root.
constexpr const char* kArrays = "arrays";

// Before a busy scheduler is asked again.
constexpr double kBusyDelay = 60.0;

void remove_stop_file(const std::filesystem::path& run_directory) {
  std::error_code error;
  std::filesystem::remove(run_directory / run_files::kStop, error);
  if (error)
    throw StorageError("cannot remove " + (run_directory / run_files::kStop).string() + ": " +
                       error.message());
}

void write_job_files(const JobSpec& spec, const SchedulerKind& kind) {
  remove_stop_file(spec.run_directory);
  write_atomic(spec.run_directory / run_files::kFence, spec.token);
  fault_point("after_fence");
  write_atomic(spec.run_directory / attempt_files::script(spec.token), kind.make_script(spec));
  fault_point("after_script");
}

// The attempt is over before any job was: the run waits, or is held when waiting does not help.
void withdraw(Store& store, RunRow run, ChunkRow chunk, AttemptRow attempt, State run_state,
              const std::string& reason, double now) {
  attempt.state = State::kCancelled;
  attempt.outcome_class = word_of(OutcomeClass::kPlumbing);
  attempt.reason = reason;
  attempt.ended_at = now;
  run.state = run_state;
  run.reason = reason;
  run.not_before = now + (run_state == State::kReady ? kBusyDelay : 0.0);
  chunk.state = run_state;
  store.apply({run, chunk, attempt, std::nullopt, false});
}

// An attempt that is written down, with its run and chunk as they are then.
struct Begun {
  RunRow run;
  ChunkRow chunk;
  AttemptRow attempt;
};

Begun begin_attempt(const JobSettings& shared, Store& store, const Submission& submission,
                    const std::string& token, double now) {
  Begun begun{submission.run, submission.chunk, {}};
  AttemptRow& attempt = begun.attempt;
  RunRow& run = begun.run;
  attempt.run = run.id;
  attempt.chunk = begun.chunk.id;
  attempt.token = token;
  attempt.state = State::kSubmitting;
  attempt.created_at = now;
  attempt.start_step = run.step;
  attempt.step = run.step;
  attempt.time = run.time;
  attempt.engine_hash = shared.engine_hash;
  attempt.ranks = static_cast<int>(shared.settings.resources.ranks);
  attempt.threads = static_cast<int>(shared.settings.resources.threads);
  if (run.step == 0 || run.engine_hash.empty()) run.engine_hash = shared.engine_hash;
  run.state = State::kSubmitting;
  run.reason.clear();
  begun.chunk.state = State::kSubmitting;
  attempt = store.add_attempt(attempt, run, begun.chunk);
  fault_point("after_tx1");
  return begun;
}

// @return "" or why the files could not be written; the run is then held
std::string prepare_files(const Begun& begun, const JobSpec& spec, const SchedulerKind& kind,
                          Store& store, double now) {
  try {
    write_job_files(spec, kind);
    return "";
  } catch (const StorageError& error) {
    withdraw(store, begun.run, begun.chunk, begun.attempt, State::kHeld, error.what(), now);
    return error.what();
  }
}

void record_answer(Store& store, const Begun& begun, const SubmitAnswer& answer, double now) {
  const RunRow& run = begun.run;
  const ChunkRow& chunk = begun.chunk;
  AttemptRow attempt = begun.attempt;
  switch (answer.kind) {
    case SubmitAnswer::Kind::kAccepted: {
      attempt.job = answer.job;
      attempt.submitted_at = now;
      attempt.state = State::kQueued;
      RunRow queued_run = run;
      queued_run.state = State::kQueued;
      ChunkRow queued_chunk = chunk;
      queued_chunk.state = State::kQueued;
      store.apply({queued_run, queued_chunk, attempt, std::nullopt, false});
      break;
    }
    case SubmitAnswer::Kind::kUnclear:
      attempt.reason = "whether the job was taken is open: " + answer.message;
      store.apply({std::nullopt, std::nullopt, attempt, std::nullopt, false});
      break;
    case SubmitAnswer::Kind::kBusy:
      withdraw(store, run, chunk, attempt, State::kReady, answer.message, now);
      break;
    case SubmitAnswer::Kind::kRefused:
      withdraw(store, run, chunk, attempt, State::kHeld, "refused: " + answer.message, now);
      break;
  }
}

}  // namespace

JobSpec job_spec(const JobSettings& shared, const RunRow& run, const ChunkRow& chunk,
                 const RunRow* bed, const std::string& token) {
  const Resources& resources = shared.settings.resources;
  const bool is_batch = scheduler_kind(shared.settings.scheduler).is_batch;
  JobSpec spec;
  spec.campaign = shared.campaign;
  spec.label = run.label;
  spec.token = token;
  spec.root = shared.root;
  spec.home = shared.home;
  spec.run_directory = shared.root / run.directory;
  spec.engine = {shared.engine, "--run-dir", spec.run_directory.string(), "--token", token,
                 "--restart",   "auto"};
  const auto add = [&](const char* option, const std::string& value) {
    spec.engine.insert(spec.engine.end(), {option, value});
  };
  // Always, so that OMP_NUM_THREADS in a job's environment changes nothing.
  add("--threads", std::to_string(resources.threads));
  if (bed != nullptr) add("--bed", (shared.root / bed->directory).string());
  if (chunk.until_time) add("--until-time", format_number(*chunk.until_time));
  if (resources.walltime > 0.0) {
    // A batch system kills at the walltime; at home nobody does, and it is the engine's own.
    const double margin = is_batch ? stop_margin(resources.walltime) : 0.0;
    add("--max-seconds", format_number(resources.walltime - margin));
  }
  if (shared.checkpoint_seconds > 0.0)
    add("--checkpoint-seconds", format_number(shared.checkpoint_seconds));
  spec.ranks = resources.ranks;
  spec.threads = resources.threads;
  spec.nodes = resources.nodes;
  spec.walltime = resources.walltime;
  spec.memory = resources.memory;
  spec.partition = resources.partition;
  spec.account = resources.account;
  spec.qos = resources.qos;
  spec.launcher = resources.launcher;
  spec.setup_file = resources.setup_file;
  spec.excluded_hosts = shared.excluded_hosts;
  spec.chain = shared.settings.chain;
  return spec;
}

std::string make_token() {
  constexpr std::size_t kLength = 12;
  constexpr const char* kCharacters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device source;
  std::uniform_int_distribution<std::size_t> pick(0, 35);
  std::string token;
  while (token.size() < kLength) token += kCharacters[pick(source)];
  return token;
}

SubmitAnswer submit_attempt(const JobSettings& shared, const SchedulerKind& kind,
                            Scheduler& scheduler, Store& store, const Submission& submission,
                            double now) {
  const Begun begun = begin_attempt(shared, store, submission, make_token(), now);
  const JobSpec spec =
      job_spec(shared, begun.run, begun.chunk, submission.bed, begun.attempt.token);
  const std::string problem = prepare_files(begun, spec, kind, store, now);
  if (!problem.empty()) return {SubmitAnswer::Kind::kRefused, "", problem};
  const std::string& token = begun.attempt.token;
  const SubmitAnswer answer =
      scheduler.submit({job_name(token), spec.run_directory / attempt_files::script(token),
                        spec.run_directory, spec.run_directory / attempt_files::log(token)});
  fault_point("after_submit");
  record_answer(store, begun, answer, now);
  fault_point("after_tx2");
  return answer;
}

SubmitAnswer submit_array(const JobSettings& shared, const SchedulerKind& kind,
                          Scheduler& scheduler, Store& store,
                          const std::vector<Submission>& submissions, std::int64_t at_once,
                          double now) {
  const std::string token = make_token();
  std::vector<Begun> members;
  ArraySpec array;
  array.name = job_name(token);
  array.at_once = at_once;
  for (const Submission& one : submissions) {
    const std::string own = member_token(token, members.size());
    const Begun begun = begin_attempt(shared, store, one, own, now);
    JobSpec spec = job_spec(shared, begun.run, begun.chunk, one.bed, own);
    spec.is_array_member = true;
    if (!prepare_files(begun, spec, kind, store, now).empty()) continue;
    array.common = spec;
    array.scripts.push_back(spec.run_directory / attempt_files::script(own));
    members.push_back(begun);
  }
  if (members.empty()) return {SubmitAnswer::Kind::kRefused, "", "no run could be prepared"};
  const auto script = shared.root / kArrays / (array.name + ".sh");
  std::filesystem::create_directories(script.parent_path());
  write_atomic(script, kind.make_array_script(array));
  SubmitAnswer answer =
      scheduler.submit({array.name, script, shared.root, shared.root / kArrays / "log"});
  fault_point("after_submit");
  for (std::size_t i = 0; i < members.size(); ++i) {
    SubmitAnswer own = answer;
    if (!own.job.empty()) own.job += "_" + std::to_string(i);
    record_answer(store, members[i], own, now);
  }
  fault_point("after_tx2");
  return answer;
}

}  // namespace grouser
