// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/driver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/atomic_file.hpp"
#include "base/check.hpp"
#include "base/errors.hpp"
#include "base/hash.hpp"
#include "campaign/drive/caution.hpp"
#include "campaign/drive/fault.hpp"
#include "campaign/plan/planner.hpp"
#include "schedulers/local.hpp"

namespace grouser {
namespace {

// Seconds between the polite request to end and the end.
constexpr double kCancelPatience = 10.0;

// So many of the last attempts tell about hosts and about the moment.
constexpr int kLookBack = 200;

// Slurm's MaxArraySize is 1001 unless the site has set another, and it bounds the index.
constexpr std::size_t kArrayMost = 1000;

std::string hash_of_file(const std::filesystem::path& file) {
  const auto content = read_file(file);
  return content ? hash_text(*content) : "";
}

Measured measured_of(const std::vector<AttemptRow>& ended) {
  Measured measured;
  for (const AttemptRow& attempt : ended) {
    if (attempt.slowest_checkpoint > 0.0)
      measured.checkpoint_costs.push_back(attempt.slowest_checkpoint);
    if (attempt.running_at == 0.0) continue;
    measured.observed += attempt.has_outcome ? attempt.wall_seconds
                                             : std::max(attempt.ended_at - attempt.running_at, 0.0);
    measured.failures += attempt.outcome_class == word_of(OutcomeClass::kInfra) ? 1 : 0;
  }
  return measured;
}

// At the speed of the run's last attempt that made steps; 0 = unknown. [s]
double computing_left(const RunRow& run, const ChunkRow& chunk,
                      const std::vector<AttemptRow>& attempts) {
  const double end = chunk.until_time.value_or(run.end_time);
  for (auto at = attempts.rbegin(); at != attempts.rend(); ++at) {
    if (at->steps_done == 0 || at->step == 0 || end <= run.time) continue;
    const double time_step = at->time / static_cast<double>(at->step);
    return (end - run.time) / time_step * at->compute_seconds / static_cast<double>(at->steps_done);
  }
  return 0.0;
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
  policy.hang = settings.limits.hang;
  policy.end_looks = kind.is_batch ? 2 : 1;
  policy.retry_delay = kind.is_batch ? settings.retries.delay : 0.0;
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
  if (shared_.settings.chain != "manager") write_wake_script();
  look_at_active();
  advance_runs();
  return report_;
}

void Driver::write_wake_script() const {
  const std::string text = make_wake_script(std::filesystem::read_symlink("/proc/self/exe"), root_);
  if (read_file(root_ / kWakeScript) != text) write_atomic(root_ / kWakeScript, text);
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
  // A wish from the future is one from before the clock was set back.
  const double waited = clock_.now() - run.requested_at;
  const bool is_impatient = waited >= kCancelPatience || waited < 0.0;
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

bool Driver::is_pausing() {
  ended_ = store_.ended_last(kLookBack);
  const double until = kind_.is_batch ? pause_end(ended_) : 0.0;
  const double left = until - clock_.now();
  if (left <= 0.0 || left > kLongestDelay) return false;
  report_.messages.push_back("the last three jobs all failed within two minutes of their start (" +
                             ended_.front().reason + "): nothing is submitted for " +
                             std::to_string(std::llround(left)) + " s");
  return true;
}

void Driver::advance_runs() {
  if (is_pausing()) return;
  shared_.excluded_hosts = kind_.is_batch ? bad_hosts(ended_) : std::vector<std::string>{};
  const std::vector<RunRow> runs = store_.runs();
  std::map<RunId, const RunRow*> by_id;
  std::int64_t jobs = 0;
  for (const RunRow& run : runs) {
    by_id[run.id] = &run;
    jobs += is_active(run.state) ? 1 : 0;
  }
  const bool as_array =
      shared_.settings.resources.array && kind_.make_array_script != nullptr && jobs == 0;
  std::vector<Submission> together;
  for (const RunRow& run : runs) {
    const bool may_start =
        run.in_plan && (run.state == State::kPlanned || run.state == State::kReady ||
                        run.state == State::kChunkDone);
    const RunRow* bed = run.bed ? by_id.at(*run.bed) : nullptr;
    // A delay longer than any is from before the clock was set back.
    const double wait = run.not_before - clock_.now();
    if (!may_start || (wait > 0.0 && wait <= kLongestDelay)) continue;
    if ((!as_array && jobs >= job_limit()) || (bed != nullptr && !has_settled(*bed))) continue;
    const auto submission = prepare(run, bed, static_cast<std::size_t>(jobs));
    if (!submission) continue;
    ++jobs;
    if (as_array)
      together.push_back(*submission);
    else
      submit(*submission);
  }
  if (together.size() == 1) submit(together.front());
  if (together.size() > 1) submit_together(together, shared_.settings.resources.concurrent);
}

void Driver::hold(const RunRow& run, const ChunkRow& chunk, const std::string& reason) {
  Change change;
  change.run = run;
  change.run->state = State::kHeld;
  change.run->reason = reason;
  change.chunk = chunk;
  change.chunk->state = State::kHeld;
  store_.apply(change);
  report_.messages.push_back(run.label + ": held, " + reason);
}

RunRow Driver::without_suspect(const RunRow& run, const std::vector<AttemptRow>& attempts) {
  if (!is_checkpoint_suspect(run, attempts)) return run;
  const RunRow before = set_aside_newest(root_, run);
  if (before.step != run.step)
    report_.messages.push_back(run.label + ": the engine died twice reading " + run.checkpoint +
                               "; it is set aside, " + before.checkpoint + " is used");
  return before;
}

std::optional<Submission> Driver::prepare(const RunRow& planned, const RunRow* bed,
                                          std::size_t active) {
  if (shared_.engine_hash.empty()) shared_.engine_hash = hash_of_file(shared_.engine);
  const auto chunks = store_.chunks(planned.id);
  const auto chunk = std::find_if(chunks.begin(), chunks.end(), [](const ChunkRow& one) {
    return one.state != State::kChunkDone;
  });
  if (chunk == chunks.end())
    throw InternalError("run " + planned.label + " is not done but has no chunk left");
  const auto attempts = store_.attempts(planned.id);
  const Settings& settings = shared_.settings;
  const double used = settings.limits.node_hours > 0.0 ? store_.occupied_seconds() : 0.0;
  // One that the scheduler never took was no job.
  const auto jobs = static_cast<std::size_t>(
      std::count_if(attempts.begin(), attempts.end(),
                    [](const AttemptRow& attempt) { return attempt.submitted_at > 0.0; }));
  std::string why_not = limit_reached(settings, jobs, used, active);
  if (why_not.empty()) why_not = engine_mismatch(planned, shared_.engine_hash);
  if (why_not.empty()) return Submission{without_suspect(planned, attempts), *chunk, bed};
  hold(planned, *chunk, why_not);
  return std::nullopt;
}

JobSettings Driver::settings_for(const Submission& submission) const {
  JobSettings own = shared_;
  const PlannerRule& planner = own.settings.planner;
  const Measured measured = measured_of(ended_);
  if (planner.checkpoints) own.checkpoint_seconds = checkpoint_seconds(measured);
  double& walltime = own.settings.resources.walltime;
  if (planner.walltime && walltime > 0.0)
    walltime = job_walltime(
        computing_left(submission.run, submission.chunk, store_.attempts(submission.run.id)),
        walltime, measured);
  return own;
}

void Driver::submit(const Submission& submission) {
  const SubmitAnswer answer =
      submit_attempt(settings_for(submission), kind_, scheduler_, store_, submission, clock_.now());
  const bool is_taken = answer.kind == SubmitAnswer::Kind::kAccepted;
  if (is_taken) ++report_.submitted;
  report_.messages.push_back(submission.run.label + ": " +
                             (is_taken ? "submitted as job " + answer.job : answer.message));
}

void Driver::submit_together(const std::vector<Submission>& submissions, std::int64_t at_once) {
  for (std::size_t from = 0; from < submissions.size(); from += kArrayMost) {
    const auto first = submissions.begin() + static_cast<std::ptrdiff_t>(from);
    const auto count = std::min(kArrayMost, submissions.size() - from);
    const SubmitAnswer answer =
        submit_array(shared_, kind_, scheduler_, store_,
                     {first, first + static_cast<std::ptrdiff_t>(count)}, at_once, clock_.now());
    const bool is_taken = answer.kind == SubmitAnswer::Kind::kAccepted;
    if (is_taken) report_.submitted += static_cast<int>(count);
    report_.messages.push_back(std::to_string(count) + " runs: " +
                               (is_taken ? "submitted as array " + answer.job : answer.message));
  }
}

bool needs_another_look(const std::vector<RunRow>& runs, const std::vector<AttemptRow>& active,
                        double now) {
  return std::any_of(active.begin(), active.end(),
                     [](const AttemptRow& attempt) {
                       return attempt.absences > 0 || attempt.outcome_at > 0.0 ||
                              attempt.state == State::kSubmitting ||
                              attempt.state == State::kUnknown;
                     }) ||
         std::any_of(runs.begin(), runs.end(), [&](const RunRow& run) {
           return run.in_plan && run.state == State::kReady && run.not_before > now;
         });
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
