// SPDX-License-Identifier: BSD-3-Clause
#include "engine/app/run.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/units.hpp"
#include "engine/app/breakdown.hpp"
#include "engine/app/setup.hpp"
#include "engine/app/slice.hpp"
#include "engine/app/snapshot.hpp"
#include "engine/core/agree.hpp"
#include "engine/terrain/bed.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSettleCheckSteps = 50;
constexpr std::int64_t kFluidCheckSteps = 500;  // of the fluid
constexpr std::size_t kKeptCheckpoints = 2;
// Table of what this class itself must remember.
constexpr const char* kOwnTable = "run";
// Wall seconds that an ending attempt needs beside its checkpoint.
constexpr double kFinaliseSeconds = 1.0;

// What ranks ask for in a step's message; the largest wins.
constexpr double kNothing = 0.0;
constexpr double kCheckpoint = 0.5;  // and to go on
constexpr double kPause = 1.0;
constexpr double kSignal = 2.0;
constexpr double kStop = 3.0;
constexpr double kStorage = 4.0;

std::atomic<bool> signal_came{false};

std::int64_t steps_in(double time, double time_step) {
  return std::max<std::int64_t>(1, std::llround(time / time_step));
}

// First step at or after a time; a hair less than a whole step is that step.
std::int64_t step_at(double time, double time_step) {
  return static_cast<std::int64_t>(std::ceil(time / time_step - 1e-6));
}

// Rank 0 writes it into checkpoints; the others need none.
std::string frozen_case(const Communicator& ranks, const fs::path& run_directory) {
  std::string text;
  on_first_rank(ranks, [&] { text = read_file(run_directory / run_files::kCase).value_or(""); });
  return text;
}

}  // namespace

void signal_stop() { signal_came = true; }

Run::Run(const Communicator& ranks, const EngineOptions& options, const Case& input,
         Clock::time_point started)
    : ranks_(ranks),
      options_(options),
      input_(input),
      key_(content_key(input.has_wheel ? input : bed_case(input))),
      started_(started),
      world_(make_world(ranks, input, options.threads)),
      ledger_(ranks),
      checkpoints_(ranks, options.run_directory / run_files::kCheckpoints,
                   frozen_case(ranks, options.run_directory)) {
  const double dt = world_.settings().time_step;
  if (OuterForces::are_in(input_)) outer_ = std::make_unique<OuterForces>(input_, world_);
  if (input_.has_wheel) wheel_ = std::make_unique<Wheel>(input_, world_, kWheelBody);
  if (input_.has_wheel || input_.has_placed) {
    end_step_ = step_at(run_duration(input_), dt);
  } else {
    settled_energy_ = settled_energy(input_);
    fall_time_ = std::sqrt(2.0 * Filling(input_).height() / input_.gravity);
  }
  if (options_.until_time)
    until_step_ = std::max<std::int64_t>(1, step_at(*options_.until_time, dt));
  series_steps_ = steps_in(input_.output.series_interval, dt);
  if (input_.output.has_track) track_steps_ = steps_in(input_.output.track.interval, dt);
  checkpoint_steps_ = steps_in(input_.output.checkpoint_interval, dt);
  if (input_.output.snapshot_interval > 0.0)
    snapshot_steps_ = steps_in(input_.output.snapshot_interval, dt);
  log_time_step(input_);
  spdlog::info("app ranks={} threads={} of each", ranks_.size(), options_.threads);

  on_first_rank(ranks_,
                [&] { fs::create_directories(options_.run_directory / run_files::kEvents); });
  if (const auto found = checkpoints_.find_newest(key_)) {
    resume(*found);
  } else if (options_.must_continue) {
    throw FormatError("no checkpoint of this case in " +
                      (options_.run_directory / run_files::kCheckpoints).string());
  } else {
    begin();
  }
  first_step_ = step_;
  reported_step_ = step_;
  particles_ = world_.particle_count();
  check_grains();
  on_first_rank(ranks_, [&] {
    series_.emplace(options_.run_directory / run_files::kSeries, kSeriesHeader, step_);
    // A row of the track is of the beginning of a step: the next one's is not there yet.
    if (track_steps_ > 0)
      track_.emplace(options_.run_directory / run_files::kTrack, track_header(), step_ - 1);
  });
  event("started", newest_);
}

bool Run::owns_fence() const {
  const auto text = read_file(options_.run_directory / run_files::kFence);
  return text && text->substr(0, text->find_last_not_of(" \n\r\t") + 1) == options_.claim;
}

void Run::begin() {
  if (!input_.has_wheel) {
    fill(world_, input_);
    return;
  }
  begin_from_bed();
}

void Run::begin_from_bed() {
  const std::string bed_key = content_key(bed_case(input_));
  if (options_.bed.empty())
    throw ConfigError({Problem{"", 0, 0, "--bed", "is needed to start a run with a wheel",
                               "give the run directory of the settled bed"}});
  CheckpointStore bed(ranks_, options_.bed / run_files::kCheckpoints);
  const auto found = bed.find_newest(bed_key);
  if (!found || !found->settled_bed)
    throw FormatError("no settled bed with key " + bed_key + " in " + options_.bed.string());
  std::vector<Stateful*> settled{&world_};
  // On a lattice the bed has settled in another mode, without one.
  if (outer_ && outer_->lattice() == nullptr) settled.push_back(outer_.get());
  for (Stateful* module : settled) module->begin_load();
  bed.read(*found, [&](const StateTable& rows) {
    for (Stateful* module : settled) module->load_rows(rows);
  });
  for (Stateful* module : settled) module->end_load();
  world_.reset_origins();
  wheel_->place();
  spdlog::info("app bed taken from {} step={}", found->file, found->step);
}

void Run::resume(const CheckpointManifest& manifest) {
  const std::vector<Stateful*> all = modules();
  for (Stateful* module : all) module->begin_load();
  checkpoints_.read(manifest, [&](const StateTable& rows) {
    for (Stateful* module : all) module->load_rows(rows);
    if (rows.name == kOwnTable) max_overlap_ = first_row(ranks_, rows).at(0);
  });
  for (Stateful* module : all) module->end_load();
  newest_ = manifest;
  step_ = manifest.step;
  spdlog::info("app continues from {} step={} time={} s", newest_.file, step_, time());
}

std::vector<Stateful*> Run::modules() {
  std::vector<Stateful*> all{&world_, &ledger_};
  if (outer_) all.push_back(outer_.get());
  if (wheel_) all.push_back(wheel_.get());
  return all;
}

// How many grains a bed has is known only now.
void Run::check_grains() const {
  std::vector<Problem> problems;
  const auto check = [&](const char* key, std::int64_t grain) {
    if (grain >= particles_)
      problems.push_back({"", 0, 0, key, "names grain " + std::to_string(grain),
                          "there are " + std::to_string(particles_) + ", numbered from 0"});
  };
  if (input_.output.has_track) check("output.track.grain", input_.output.track.grain);
  for (const ProbeCase& probe : input_.probes) check("probes.grain", probe.grain);
  if (!problems.empty()) throw ConfigError(problems);
}

double Run::elapsed() const {
  return std::chrono::duration<double>(Clock::now() - started_).count();
}

std::string Run::phase() const {
  if (input_.has_placed) return "moving";
  if (!wheel_) return "settling";
  return wheel_->is_driving(time()) ? "driving" : "wheel_settling";
}

bool Run::is_done() const { return end_step_ > 0 ? step_ >= end_step_ : newest_.settled_bed; }

double Run::request() const {
  if (signal_came) return kSignal;
  if (ranks_.rank() != 0) return kNothing;
  if (options_.max_seconds &&
      elapsed() + 1.5 * slowest_checkpoint_ + kFinaliseSeconds > *options_.max_seconds)
    return kPause;
  const bool is_due =
      options_.checkpoint_seconds && elapsed() - checkpointed_at_ >= *options_.checkpoint_seconds;
  std::error_code ignored;
  const fs::path stop = options_.run_directory / run_files::kStop;
  if (step_ % 64 != 0 || !fs::exists(stop, ignored)) return is_due ? kCheckpoint : kNothing;
  // One that cannot be read asks all the same; rank 0 must not throw alone.
  std::string text;
  std::getline(std::ifstream(stop), text);
  return text.starts_with("signal") ? kSignal : kStop;
}

Outcome Run::execute() {
  if (is_done()) {
    reason_ = "already at its end";
    return outcome(EngineCode::kFinished);
  }
  if (!newest_.file.empty() && until_step_ > 0 && step_ >= until_step_) {
    reason_ = "already at the end of the chunk";
    return outcome(EngineCode::kPaused);
  }
  // The very first checkpoint costs little and makes every later failure restartable; it also
  // measures what a checkpoint costs here.
  if (newest_.file.empty() && !write_checkpoint(false)) return outcome(EngineCode::kFenceLost);
  for (;;) {
    double wanted = request();
    if (!report_progress(false)) wanted = kStorage;
    const World::StepResult result = one_step(wanted);
    ledger_.add_work(world_);
    if (wheel_) wheel_->advance(time(), result.max_overlap);
    max_overlap_ = std::max(max_overlap_, result.max_overlap);
    largest_overlap_ = std::max(largest_overlap_, result.max_overlap);
    if (const auto code = after_step(result)) {
      // A run that another attempt owns is left as it is.
      if (*code != EngineCode::kFenceLost) {
        write_slice();
        report_progress(true);
        log_sleepers();
      }
      return outcome(*code);
    }
  }
}

World::StepResult Run::one_step(double request) {
  const bool with_track = track_steps_ > 0 && step_ % track_steps_ == 0;
  if (outer_) outer_->announce(step_, time(), with_track);
  const World::StepResult result = world_.step(request);
  if (outer_) outer_->load_bodies();
  if (with_track) add_track_row(step_);
  ++step_;
  return result;
}

void Run::add_track_row(std::int64_t step) {
  const auto row = outer_->take_row();
  if (row && track_) track_->add(step, time(), "", track_values(*row));
}

std::optional<EngineCode> Run::after_step(const World::StepResult& result) {
  if (const auto what = breakdown(result)) {
    reason_ = "at step " + std::to_string(step_) + ", " + rounded(time()) + " s, " + *what;
    return EngineCode::kBrokeDown;
  }
  if (step_ % series_steps_ == 0) add_series_row();
  if (snapshot_steps_ > 0 && step_ % snapshot_steps_ == 0) {
    const fs::path directory = options_.run_directory / run_files::kSnapshots;
    write_snapshot(world_, directory, step_, time());
    if (outer_ && outer_->lattice() != nullptr)
      write_fluid_snapshot(ranks_, *outer_->lattice(), directory, step_, time());
  }
  if (const auto code = check_settling()) return code;
  const bool run_ends = end_step_ > 0 && step_ >= end_step_;
  const bool chunk_ends = until_step_ > 0 && step_ >= until_step_;
  if (run_ends || chunk_ends) {
    if (!write_checkpoint(false)) return EngineCode::kFenceLost;
    reason_ = run_ends ? "the run is at its end" : "the chunk is at its end";
    return run_ends ? EngineCode::kFinished : EngineCode::kPaused;
  }
  if (result.request >= kPause) return end_by_request(result.request);
  if (saves_after(result) && !write_checkpoint(false)) return EngineCode::kFenceLost;
  return std::nullopt;
}

// Whether a checkpoint follows this step, as far as the clock, the step and requests say.
bool Run::saves_after(const World::StepResult& result) const {
  if ((end_step_ > 0 && step_ >= end_step_) || (until_step_ > 0 && step_ >= until_step_))
    return true;
  if (result.request >= kPause) return true;
  return options_.checkpoint_seconds ? result.request == kCheckpoint
                                     : step_ % checkpoint_steps_ == 0;
}

std::optional<std::string> Run::breakdown(const World::StepResult& result) {
  if (auto what = breakdown_of(world_, result, input_)) return what;
  if (wheel_ && !wheel_->fault().empty()) return wheel_->fault();
  // Seldom, because it walks over all cells; and before every checkpoint, which must be good.
  if (outer_ && outer_->lattice() != nullptr) {
    const ResolvedFlow& fluid = *outer_->lattice();
    const bool is_due = step_ % (kFluidCheckSteps * fluid.scale().substeps) == 0;
    if (is_due || saves_after(result))
      if (auto what = breakdown_of(fluid)) return what;
  }
  if (step_ % EnergyLedger::kInterval != 0) return std::nullopt;
  const World::Survey survey = world_.survey();
  mean_overlap_ = survey.mean_overlap;
  // What outer forces do to the grains is not in the ledger.
  if (outer_ || !ledger_.rises(survey)) return std::nullopt;
  return heating_text(ledger_, survey, input_);
}

std::optional<EngineCode> Run::check_settling() {
  if (end_step_ > 0 || step_ % kSettleCheckSteps != 0 || time() < fall_time_) return std::nullopt;
  const double energy = world_.kinetic_energy() / static_cast<double>(particles_);
  if (energy < settled_energy_) {
    if (!write_checkpoint(true)) return EngineCode::kFenceLost;
    reason_ = "the bed has settled";
    return EngineCode::kFinished;
  }
  if (time() > input_.bed.settle_limit) {
    reason_ = "the bed has not settled within bed.settle_limit: " + std::to_string(energy) +
              " J per grain are over " + std::to_string(settled_energy_);
    return EngineCode::kBrokeDown;
  }
  return std::nullopt;
}

EngineCode Run::end_by_request(double request) {
  if (request >= kStorage) {
    reason_ = "progress could not be written";
    return EngineCode::kStorageFailed;
  }
  if (!write_checkpoint(false)) return EngineCode::kFenceLost;
  by_signal_ = request == kSignal;
  reason_ = request >= kStop ? "stopped on request"
            : by_signal_     ? "a signal asked for the end"
                             : "the walltime is nearly used up";
  return request >= kStop ? EngineCode::kStopped : EngineCode::kPaused;
}

State Run::state(const StatePiece& piece) const {
  State state;
  world_.save_state(state, piece);
  if (outer_) outer_->save_state(state, piece);
  if (wheel_) wheel_->save_state(state, piece);
  ledger_.save_state(state, piece);
  StateTable own;
  own.name = kOwnTable;
  own.key_count = own.all_rows = 1;
  own.real_fields = {{"max_overlap", "1", 1}};
  if (ranks_.rank() == 0 && piece.has(0, 1)) {
    own.integers = {0, 0};
    own.reals = {max_overlap_};
  }
  state.push_back(std::move(own));
  return state;
}

std::int64_t Run::rows_of_state() const {
  if (!outer_ || outer_->lattice() == nullptr) return particles_;
  const CellCounts& cells = outer_->lattice()->flow().blocks().cells();
  return std::max(particles_, cells[0] * cells[1] * cells[2]);
}

bool Run::write_checkpoint(bool settled) {
  const double from = elapsed();
  CheckpointManifest manifest;
  manifest.case_key = key_;
  manifest.step = step_;
  manifest.time = time();
  manifest.settled_bed = settled;
  // Rows up to this step must be in the file before a state that lies behind them exists. They
  // are written by the owner of the run alone.
  bool owns = true;
  on_first_rank(ranks_, [&] {
    owns = owns_fence();
    if (owns) series_->flush();
    if (owns && track_) track_->flush();
  });
  if (ranks_.from_first(owns ? 1 : 0) == 0) {
    reason_ = "another attempt owns the run";
    return false;
  }
  checkpoints_.remove_leftovers();  // before the write, which may need their room
  const auto written = checkpoints_.write([&](const StatePiece& piece) { return state(piece); },
                                          checkpoints_.pieces_for(rows_of_state()), manifest,
                                          [&] {
                                            try {
                                              return owns_fence();
                                            } catch (const StorageError& error) {
                                              spdlog::error("app {}", error.what());
                                              return false;
                                            }
                                          });
  if (!written) {
    reason_ = "another attempt owns the run";
    return false;
  }
  newest_ = *written;
  checkpoints_.retain(kKeptCheckpoints);
  event("checkpoint", newest_);
  const double cost = ranks_.max(elapsed() - from);
  checkpoint_seconds_ += cost;
  slowest_checkpoint_ = std::max(slowest_checkpoint_, cost);
  checkpointed_at_ = elapsed();
  return true;
}

void Run::add_series_row() {
  const double kinetic = world_.kinetic_energy();
  const auto contacts = static_cast<double>(world_.contacts());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values(15, kNone);
  if (wheel_) {
    const WheelSample s = wheel_->take_sample();
    const double load = input_.wheel.load;
    values = {s.travel,
              s.sinkage,
              s.slip(wheel_->radius()),
              s.skid(wheel_->radius()),
              s.spin,
              s.forward_speed,
              s.vertical_speed,
              s.pull,
              s.vertical_force,
              s.side_force,
              s.gross_tractive_effort,
              s.motion_resistance(),
              s.pull / load,
              s.gross_tractive_effort / load,
              s.axle_torque / (wheel_->radius() * load)};
    max_overlap_ = s.max_overlap;
  }
  values.insert(values.end(), {kinetic, max_overlap_, contacts});
  if (series_) series_->add(step_, time(), phase(), values);
  max_overlap_ = 0.0;
}

bool Run::report_progress(bool now) {
  if (ranks_.rank() != 0) return true;
  const double at = elapsed();
  if (!now && (step_ % 16 != 0 || at - reported_at_ < 1.0)) return true;
  if (at > reported_at_ && step_ > reported_step_)
    speed_ = static_cast<double>(step_ - reported_step_) * static_cast<double>(particles_) /
             (at - reported_at_);
  reported_at_ = at;
  reported_step_ = step_;
  Progress progress;
  progress.token = options_.token;
  progress.step = step_;
  progress.time = time();
  progress.end_time = static_cast<double>(end_step_) * world_.settings().time_step;
  progress.particle_steps_per_second = speed_;
  if (end_step_ > 0 && speed_ > 0.0)
    progress.seconds_left =
        static_cast<double>(end_step_ - step_) * static_cast<double>(particles_) / speed_;
  progress.phase = phase();
  try {
    write_atomic(options_.run_directory / run_files::kProgress, to_json(progress));
  } catch (const StorageError& error) {
    spdlog::error("app {}", error.what());
    return false;
  }
  return true;
}

void Run::write_slice() {
  const std::string text = slice_text(world_, input_);
  const std::string failure = agreed_failure(ranks_, [&] {
    if (ranks_.rank() == 0) write_atomic(options_.run_directory / run_files::kSlice, text);
  });
  // A picture less does not undo a run.
  if (!failure.empty()) spdlog::warn("app {}", failure);
}

void Run::log_sleepers() const {
  if (world_.settings().activity.interval == 0) return;
  spdlog::info(
      "app {} of {} grains sleep; falling asleep has taken {} J of motion since the start, the "
      "wheel has done {} J of work",
      world_.sleepers(), particles_, rounded(world_.taken_by_sleep()), rounded(ledger_.work()));
}

void Run::event(const std::string& kind, const CheckpointManifest& manifest) {
  Event record;
  record.token = options_.token;
  record.sequence = events_++;
  record.kind = kind;
  for (const char* name : {"SLURM_JOB_ID", "PBS_JOBID", "GROUSER_JOB"})
    if (const char* job = std::getenv(name); job != nullptr && record.job.empty()) record.job = job;
  record.step = manifest.step;
  record.time = manifest.time;
  record.checkpoint = manifest.file;
  record.state_hash = manifest.state_hash;
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  record.host = host;
  on_first_rank(ranks_, [&] { write_event(options_.run_directory, record); });
}

Outcome Run::outcome(EngineCode code) const {
  Outcome out;
  out.token = options_.token;
  out.code = code;
  out.reason = reason_;
  out.by_signal = by_signal_;
  out.step = step_;
  out.time = time();
  out.end_time = static_cast<double>(end_step_) * world_.settings().time_step;
  out.checkpoint = newest_.file;
  out.state_hash = newest_.state_hash;
  out.max_overlap = largest_overlap_;
  out.mean_overlap = mean_overlap_;
  out.particles = particles_;
  out.steps_done = step_ - first_step_;
  out.wall_seconds = elapsed();
  out.checkpoint_seconds = checkpoint_seconds_;
  out.slowest_checkpoint_seconds = slowest_checkpoint_;
  out.compute_seconds = std::max(0.0, elapsed() - checkpoint_seconds_);
  out.ranks = ranks_.size();
  out.threads = options_.threads;
  return out;
}

}  // namespace grouser
