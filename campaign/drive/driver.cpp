// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/driver.hpp"

#include <algorithm>
#include <limits>

#include "base/atomic_file.hpp"
#include "base/check.hpp"
#include "base/errors.hpp"
#include "base/hash.hpp"
#include "campaign/drive/fault.hpp"
#include "schedulers/local.hpp"

namespace grouser {
namespace {

// Seconds between the polite request to end and the end.
constexpr double kCancelPatience = 10.0;

std::string hash_of_file(const std::filesystem::path& file) {
  const auto content = read_file(file);
  return content ? hash_text(*content) : "";
}

bool has_settled(const RunRow& run) {
  return run.state == State::kCompleted || run.state == State::kSteady;
}

}  // namespace

ChunkRow chunk_of(const Store& store, const AttemptRow& attempt) {
  for (const ChunkRow& chunk : store.chunks(attempt.run))
    if (chunk.id == attempt.chunk) return chunk;
  throw InternalError("attempt " + attempt.token + " has no chunk");
}

Policy policy_of(const SchedulerKind& kind, const Settings& settings, const Patience& patience) {
  Policy policy;
  policy.retries = settings.retries.infrastructure;
  policy.grace = patience.grace.value_or(kind.grace);
  policy.end_looks = kind.is_batch ? 2 : 1;
  policy.retry_delay = kind.is_batch ? 60.0 : 0.0;
  return policy;
}

std::vector<JobKey> keys_of(const std::vector<AttemptRow>& attempts) {
  std::vector<JobKey> keys;
  for (const AttemptRow& attempt : attempts)
    keys.push_back({job_name(attempt.token), attempt.job, attempt.created_at});
  return keys;
}

Evidence evidence_of(const std::filesystem::path& root, const RunRow& run,
                     const AttemptRow& attempt, const QueryAnswer& answer) {
  Evidence evidence = read_evidence(root / run.directory, attempt.token);
  evidence.scheduler_answered = answer.is_complete;
  evidence.why_not_answered = answer.why_not;
  for (const JobStatus& job : answer.jobs)
    if (job.name == job_name(attempt.token)) evidence.job = job;
  return evidence;
}

JobSettings job_settings(const std::filesystem::path& root, const Store& store) {
  const CampaignRow campaign = store.campaign();
  JobSettings shared;
  shared.root = root;
  shared.campaign = campaign.name;
  shared.engine = campaign.engine;
  shared.home = home_directory();
  shared.settings = read_settings(campaign.settings);
  return shared;
}

Driver::Driver(const std::filesystem::path& root, Store& store, Scheduler& scheduler, Clock& clock,
               const Patience& patience)
    : root_(root),
      store_(store),
      scheduler_(scheduler),
      clock_(clock),
      shared_(job_settings(root, store)),
      kind_(scheduler_kind(shared_.settings.scheduler)),
      policy_(policy_of(kind_, shared_.settings, patience)) {}

TickReport Driver::tick() {
  report_ = {};
  look_at_active();
  advance_runs();
  return report_;
}

void Driver::look_at_active() {
  const auto active = store_.active_attempts();
  if (active.empty()) return;
  const QueryAnswer answer = scheduler_.query(keys_of(active));
  if (!answer.is_complete) report_.messages.push_back("scheduler: " + answer.why_not);
  for (const AttemptRow& attempt : active) look_at(attempt, answer);
}

void Driver::look_at(const AttemptRow& attempt, const QueryAnswer& answer) {
  const RunRow run = store_.run(attempt.run);
  const Evidence evidence = evidence_of(root_, run, attempt, answer);
  const double now = clock_.now();
  const Sighting sighting = look(attempt, evidence, policy_, now);
  const auto change =
      consequence(run, chunk_of(store_, attempt), attempt, sighting, evidence, policy_, now);
  if (sighting.must_cancel)
    scheduler_.cancel({job_name(attempt.token), attempt.job, 0.0}, CancelMode::kKill);
  if (sighting.ending) {
    end_attempt(*change);
    return;
  }
  if (!run.request.empty()) carry_out_request(run, sighting.attempt);
  if (change) store_.apply(*change);
}

void Driver::carry_out_request(const RunRow& run, const AttemptRow& attempt) {
  const JobKey key{job_name(attempt.token), attempt.job, attempt.created_at};
  const bool is_queued = attempt.state == State::kQueued;
  if (run.request == "stop") create_exclusive(root_ / run.directory / run_files::kStop, "user\n");
  // A job that only waits has nothing to save.
  if (run.request == "stop" && !is_queued) return;
  const bool is_impatient = clock_.now() - run.requested_at >= kCancelPatience;
  const auto mode = is_impatient && !is_queued ? CancelMode::kKill : CancelMode::kTerminate;
  const std::string problem = scheduler_.cancel(key, mode);
  if (!problem.empty()) report_.messages.push_back(run.label + ": " + problem);
}

void Driver::end_attempt(const Change& change) {
  fault_point("before_settle");
  store_.apply(change);
  fault_point("after_settle");
  ++report_.ended;
  std::string message = change.run->label + ": attempt " + std::to_string(change.attempt->number) +
                        " ended " + word_of(change.attempt->state);
  if (!change.attempt->reason.empty()) message += " (" + change.attempt->reason + ")";
  report_.messages.push_back(message + ", run " + word_of(change.run->state));
}

std::int64_t Driver::job_limit() const {
  const Resources& resources = shared_.settings.resources;
  if (resources.concurrent > 0) return resources.concurrent;
  if (kind_.is_batch) return std::numeric_limits<std::int64_t>::max();
  return std::max<std::int64_t>(1, available_cores() / (resources.ranks * resources.threads));
}

void Driver::advance_runs() {
  const std::vector<RunRow> runs = store_.runs();
  std::map<RunId, const RunRow*> by_id;
  std::int64_t jobs = 0;
  for (const RunRow& run : runs) {
    by_id[run.id] = &run;
    jobs += is_active(run.state) ? 1 : 0;
  }
  for (const RunRow& run : runs) {
    const bool may_start =
        run.in_plan && (run.state == State::kPlanned || run.state == State::kReady ||
                        run.state == State::kChunkDone);
    const RunRow* bed = run.bed ? by_id.at(*run.bed) : nullptr;
    if (!may_start || jobs >= job_limit() || run.not_before > clock_.now()) continue;
    if (bed != nullptr && !has_settled(*bed)) continue;
    submit(run, bed);
    ++jobs;
  }
}

void Driver::submit(const RunRow& run, const RunRow* bed) {
  if (shared_.engine_hash.empty()) shared_.engine_hash = hash_of_file(shared_.engine);
  for (const ChunkRow& chunk : store_.chunks(run.id)) {
    if (chunk.state == State::kChunkDone) continue;
    const SubmitAnswer answer =
        submit_attempt(shared_, kind_, scheduler_, store_, run, chunk, bed, clock_.now());
    if (answer.kind == SubmitAnswer::Kind::kAccepted) {
      ++report_.submitted;
      report_.messages.push_back(run.label + ": submitted as job " + answer.job);
    } else {
      report_.messages.push_back(run.label + ": " + answer.message);
    }
    return;
  }
  throw InternalError("run " + run.label + " is not done but has no chunk left");
}

bool is_at_rest(const std::vector<RunRow>& runs) {
  std::map<RunId, State> states;
  for (const RunRow& run : runs) states[run.id] = run.state;
  return std::all_of(runs.begin(), runs.end(), [&](const RunRow& run) {
    if (!run.in_plan) return !is_active(run.state);
    if (is_terminal(run.state) || run.state == State::kHeld) return true;
    if (run.state != State::kPlanned || !run.bed) return false;
    const State bed = states.at(*run.bed);
    return bed == State::kHeld || bed == State::kFailed || bed == State::kCancelled;
  });
}

}  // namespace grouser
