// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/case.hpp"
#include "base/run_contract.hpp"
#include "engine/app/energy_ledger.hpp"
#include "engine/coupling/outer_forces.hpp"
#include "engine/dem/world.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/io/series.hpp"
#include "engine/terrain/wheel.hpp"

namespace grouser {

/// Command line of the engine; see docs/reference/formats/run_directory.md.
struct EngineOptions {
  std::filesystem::path run_directory;
  std::string token;
  std::string claim;  ///< text of the fence as it was found at the start: token, and perhaps how
                      ///< often the batch system started the job over
  std::filesystem::path bed;
  std::optional<double> until_time;          ///< [s]
  std::optional<double> max_seconds;         ///< of wall time, from the engine's start [s]
  std::optional<double> checkpoint_seconds;  ///< wall time between checkpoints, in place of the
                                             ///< case's interval [s]
  bool must_continue = false;                ///< refuse to start anew
  int threads = 1;                           ///< of this rank
};

/// Asks the running engine to write a checkpoint and end with kPaused; for signal handlers. Local.
void signal_stop();

/// One attempt of one run: from its newest checkpoint, or its beginning, to the end of the chunk,
/// of the run, of the walltime, or until it is stopped or breaks.
class Run {
 public:
  using Clock = std::chrono::steady_clock;

  /// @throws ConfigError, FormatError, StorageError on every rank. Collective.
  Run(const Communicator& ranks, const EngineOptions& options, const Case& input,
      Clock::time_point started);

  /// Steps until something ends the attempt. Collective.
  Outcome execute();

  /// Where the run stands, as the last word of an attempt that ends so. Local.
  Outcome outcome(EngineCode code) const;

 private:
  void begin();
  void begin_from_bed();
  void check_grains() const;
  std::vector<Stateful*> modules();
  void resume(const CheckpointManifest& manifest);
  State state(const StatePiece& piece) const;
  bool owns_fence() const;

  bool is_done() const;
  std::optional<EngineCode> after_step(const World::StepResult& result);
  std::optional<std::string> breakdown(const World::StepResult& result);
  bool saves_after(const World::StepResult& result) const;
  std::int64_t rows_of_state() const;
  std::optional<EngineCode> check_settling();
  double request() const;
  EngineCode end_by_request(double request);

  bool write_checkpoint(bool settled);
  World::StepResult one_step(double request);
  void add_series_row();
  void add_track_row(std::int64_t step);
  bool report_progress(bool now);  // whether it could be written
  void write_slice();
  void log_sleepers() const;
  void event(const std::string& kind, const CheckpointManifest& manifest);

  double time() const { return static_cast<double>(step_) * world_.settings().time_step; }
  double elapsed() const;
  std::string phase() const;

  Communicator ranks_;
  EngineOptions options_;
  Case input_;
  std::string key_;
  Clock::time_point started_;
  World world_;
  EnergyLedger ledger_;
  std::unique_ptr<OuterForces> outer_;
  std::unique_ptr<Wheel> wheel_;
  CheckpointStore checkpoints_;
  std::optional<SeriesFile> series_;  // rank 0
  std::optional<SeriesFile> track_;   // rank 0, if the case has one
  CheckpointManifest newest_;
  std::string reason_;
  bool by_signal_ = false;
  std::int64_t particles_ = 0;
  std::int64_t step_ = 0;
  std::int64_t first_step_ = 0;
  std::int64_t end_step_ = 0;    // 0 = not known
  std::int64_t until_step_ = 0;  // 0 = none
  std::int64_t series_steps_ = 1;
  std::int64_t track_steps_ = 0;  // 0 = none
  std::int64_t checkpoint_steps_ = 1;
  std::int64_t snapshot_steps_ = 0;  // 0 = none
  std::int64_t events_ = 0;
  double settled_energy_ = 0.0;
  double fall_time_ = 0.0;
  double checkpoint_seconds_ = 0.0;
  double slowest_checkpoint_ = 0.0;
  double checkpointed_at_ = 0.0;  // elapsed()
  double reported_at_ = 0.0;
  std::int64_t reported_step_ = 0;
  double speed_ = 0.0;
  double max_overlap_ = 0.0;      // since the last row of the series
  double largest_overlap_ = 0.0;  // since the attempt began
  double mean_overlap_ = 0.0;     // when last looked at
};

}  // namespace grouser
