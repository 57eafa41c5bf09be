// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

/// What the engine and the campaign manager agree on: exit codes, the files of a run directory and
/// the records in them. Neither includes the other; both include this.
/// Formats: docs/reference/formats/run_directory.md.
namespace grouser {

/// Exit codes of `grouser-engine`; also `code` in the outcome record.
enum class EngineCode : int {
  kFinished = 0,       ///< the run reached its end
  kPaused = 10,        ///< end of chunk or walltime, or a signal; checkpoint complete, continue
  kSteady = 11,        ///< steady state reached, nothing more to do
  kStopped = 12,       ///< stopped on request (stop file), checkpoint complete
  kInputRefused = 20,  ///< case, STL or command line cannot be used
  kCheckpointRefused = 21,  ///< no usable checkpoint although one must exist
  kFenceLost = 22,          ///< another attempt owns the run; nothing was touched
  kBrokeDown = 30,          ///< NaN, lost particle or over-large overlap
  kStorageFailed = 40,      ///< file system full or failing; the previous checkpoint stands
  kParallelFailed = 50,     ///< MPI or node failure
  kDefect = 70,             ///< internal defect
};

/// One word per code, as in logs, database and docs: "finished", "paused", ...
const char* word_of(EngineCode code);

/// Names inside a run directory.
namespace run_files {
inline constexpr const char* kCase = "case.yaml";  ///< frozen input, SI units
inline constexpr const char* kFence = "fence";     ///< token of the attempt that owns the run
inline constexpr const char* kStop = "stop";       ///< its existence asks the engine to stop;
                                                   ///< "signal" in it: the job got a signal
inline constexpr const char* kProgress = "progress.json";  ///< renewed about once a second
inline constexpr const char* kSeries = "series.csv";       ///< time series, one row per interval
inline constexpr const char* kTrack = "track.csv";         ///< motion and forces of one grain
inline constexpr const char* kSlice = "slice.csv";  ///< grains near the mid-plane, for pictures
inline constexpr const char* kCheckpoints = "checkpoints";  ///< directory
inline constexpr const char* kSnapshots = "snapshots";      ///< directory of VTKHDF files
inline constexpr const char* kEvents = "events";            ///< directory of event records
std::string step_digits(std::int64_t step);                 ///< twelve, as in files' names
std::string outcome(const std::string& token);              ///< outcome-<token>.json
}  // namespace run_files

/// Last word of an attempt, written by rank 0 with write_atomic. The campaign believes this file
/// first, then the scheduler, then the exit code.
struct Outcome {
  std::string token;
  EngineCode code = EngineCode::kDefect;
  std::string reason;         ///< one sentence for people
  bool by_signal = false;     ///< ended early because the batch system or a person sent a signal
  std::int64_t step = 0;      ///< last completed step
  double time = 0.0;          ///< simulated time of that step [s]
  double end_time = 0.0;      ///< simulated time at which the run is done, if known, else 0 [s]
  std::string checkpoint;     ///< file name in checkpoints/ of the newest complete one, or ""
  std::string state_hash;     ///< of that checkpoint's state: same bits, same hash
  double max_overlap = 0.0;   ///< largest since the attempt began, over the smaller radius [1]
  double mean_overlap = 0.0;  ///< of touching grains, at the last look of the attempt [1]
  std::int64_t particles = 0;
  std::int64_t steps_done = 0;   ///< steps computed by this attempt
  double wall_seconds = 0.0;     ///< whole attempt [s]
  double compute_seconds = 0.0;  ///< time stepping alone [s]
  double checkpoint_seconds = 0.0;
  double slowest_checkpoint_seconds = 0.0;  ///< the longest that one took [s]
  int ranks = 1;
  int threads = 1;  ///< of each rank
};

std::string to_json(const Outcome& outcome);
/// @throws FormatError naming `source` when the text is not an outcome record.
Outcome outcome_from_json(const std::string& text, const std::string& source);

/// progress.json: where a running attempt is.
struct Progress {
  std::string token;
  std::int64_t step = 0;
  double time = 0.0;      ///< simulated [s]
  double end_time = 0.0;  ///< simulated time at which the run is done, 0 if unknown [s]
  double particle_steps_per_second = 0.0;
  double seconds_left = -1.0;  ///< wall time until the run is done, -1 if unknown [s]
  std::string phase;           ///< "filling", "settling", "wheel_settling", "driving"
};

std::string to_json(const Progress& progress);
/// @throws FormatError
Progress progress_from_json(const std::string& text, const std::string& source);

/// Event records: events/<sequence>-<token>-<kind>.json, one file each, never rewritten.
/// Kinds: "started" {job}, "checkpoint" {step, time, file, state_hash}.
struct Event {
  std::string token;
  std::int64_t sequence = 0;  ///< counts up within the attempt
  std::string kind;
  std::string job;  ///< scheduler's job id if the environment told it
  std::int64_t step = 0;
  double time = 0.0;
  std::string checkpoint;
  std::string state_hash;
  std::string host;
};

std::string to_json(const Event& event);
Event event_from_json(const std::string& text, const std::string& source);
void write_event(const std::filesystem::path& run_directory, const Event& event);

/// Manifest of one complete checkpoint: checkpoints/<name>.json beside checkpoints/<name>.h5.
/// A checkpoint without a readable manifest does not exist.
struct CheckpointManifest {
  std::string file;      ///< name of the HDF5 file
  std::string case_key;  ///< content_key of the case it belongs to
  std::int64_t step = 0;
  double time = 0.0;
  std::string state_hash;
  std::int64_t bytes = 0;    ///< size of the HDF5 file
  bool settled_bed = false;  ///< a bed at rest that wheel runs may start from
};

std::string to_json(const CheckpointManifest& manifest);
CheckpointManifest manifest_from_json(const std::string& text, const std::string& source);

/// Columns of series.csv, in order, with their units as the header spells them.
/// Signs: x forward, z up; forces are those of the soil on the wheel; pull is forward positive,
/// gross tractive effort positive when the soil resists forward rotation, sinkage downward
/// positive.
inline constexpr const char* kSeriesHeader =
    "step [1],time [s],phase,travel [m],sinkage [m],slip [1],skid [1],spin [rad s-1],"
    "forward_speed [m s-1],vertical_speed [m s-1],pull [N],vertical_force [N],side_force [N],"
    "gross_tractive_effort [N],motion_resistance [N],pull_coefficient [1],"
    "gross_coefficient [1],traction_coefficient [1],kinetic_energy [J],max_overlap [1],"
    "contacts [1]";

}  // namespace grouser
