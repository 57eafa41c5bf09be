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

void record_answer(Store& store, const RunRow& run, const ChunkRow& chunk, AttemptRow attempt,
                   const SubmitAnswer& answer, double now) {
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
                            Scheduler& scheduler, Store& store, RunRow run, ChunkRow chunk,
                            const RunRow* bed, double now) {
  AttemptRow attempt;
  attempt.run = run.id;
  attempt.chunk = chunk.id;
  attempt.token = make_token();
  attempt.state = State::kSubmitting;
  attempt.created_at = now;
  attempt.start_step = run.step;
  attempt.step = run.step;
  attempt.time = run.time;
  attempt.engine_hash = shared.engine_hash;
  run.state = State::kSubmitting;
  run.reason.clear();
  chunk.state = State::kSubmitting;
  attempt = store.add_attempt(attempt, run, chunk);
  fault_point("after_tx1");
  const JobSpec spec = job_spec(shared, run, chunk, bed, attempt.token);
  try {
    write_job_files(spec, kind);
  } catch (const StorageError& error) {
    withdraw(store, run, chunk, attempt, State::kHeld, error.what(), now);
    return {SubmitAnswer::Kind::kRefused, "", error.what()};
  }
  const SubmitAnswer answer = scheduler.submit(
      {job_name(attempt.token), spec.run_directory / attempt_files::script(attempt.token),
       spec.run_directory, spec.run_directory / attempt_files::log(attempt.token)});
  fault_point("after_submit");
  record_answer(store, run, chunk, attempt, answer, now);
  fault_point("after_tx2");
  return answer;
}

}  // namespace grouser
