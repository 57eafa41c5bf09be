// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/case.hpp"
#include "campaign/report/observables.hpp"
#include "campaign/report/recorded_series.hpp"
#include "campaign/report/recording.hpp"
#include "campaign/report/settings.hpp"

namespace grouser {

/// Everything a report is made of, as plain values: what is drawn and written depends on this
/// alone.

/// series.csv of a run, by column. Fields that mean nothing in a phase are NaN.
struct RunSeries {
  std::vector<std::string> phase;
  std::vector<double> time;                                       ///< [s]
  std::vector<double> travel;                                     ///< [m]
  std::vector<double> forward_speed;                              ///< [m s-1]
  std::vector<double> spin;                                       ///< [rad s-1]
  std::array<std::vector<double>, kObservableCount> observables;  ///< SI

  std::size_t size() const { return time.size(); }
  const std::vector<double>& of(Observable o) const { return observables[index_of(o)]; }
};

/// slice.csv of a run: grains near the mid-plane at the end of the newest attempt.
struct BedSlice {
  struct Grain {
    double x;             ///< [m]
    double z;             ///< [m]
    double radius;        ///< [m]
    double displacement;  ///< since the start of the run [m]
  };
  std::vector<Grain> grains;
  std::size_t every = 1;                         ///< every n-th grain was kept
  std::vector<std::pair<double, double>> wheel;  ///< outline, x and z [m]
  double box_length = 0.0;                       ///< [m]
  double wall_height = 0.0;                      ///< [m]
};

/// track.csv of a run: how the tracked grain moved.
struct TrackSeries {
  std::vector<double> time;      ///< [s]
  std::vector<double> gap;       ///< lowest point over the floor [m]
  std::vector<double> velocity;  ///< upward [m s-1]
};

/// One attempt of a chunk, as the ledger shows it.
struct AttemptData {
  std::int64_t chunk = 0;   ///< 1, 2, 3 ... within the run
  std::int64_t number = 0;  ///< of the attempt within the run
  std::string state;        ///< word of a State
  std::string outcome;      ///< what ended it, "" while it runs
  std::string job;
  std::string host;      ///< "" when not known
  double started = 0.0;  ///< seconds since 1970 on the manager's host, 0 = not known
  double wall_seconds = 0.0;
  double compute_seconds = 0.0;
  double checkpoint_seconds = 0.0;
  double useful_seconds = 0.0;  ///< computing that is in the run's state
  double lost_seconds = 0.0;    ///< computing that is not, and standing still
  std::int64_t start_step = 0;
  std::int64_t steps_done = 0;
  std::int64_t particles = 0;
  int ranks = 0;
  std::string restart_hash;  ///< of the checkpoint it continued from, "" for a first start
  std::string state_hash;    ///< of its last checkpoint
};

struct RunData {
  std::string label;
  std::string directory;  ///< relative to the campaign root
  std::string key;
  std::string state;                                      ///< word of a State
  std::string reason;                                     ///< why held or failed
  bool is_bed = false;                                    ///< settles a bed; has no wheel
  bool is_finished = false;                               ///< completed or steady
  std::vector<std::pair<std::string, std::string>> axes;  ///< axis and label, in the sweep's order
  bool has_case = false;  ///< `input` was read; a planned run may not have it yet
  Case input;
  double time = 0.0;      ///< simulated, at the last checkpoint [s]
  double end_time = 0.0;  ///< 0 = unknown [s]
  std::int64_t particles = 0;
  std::string state_hash;
  RunSeries series;
  BedSlice slice;
  TrackSeries track;  ///< empty when no grain is tracked
  std::vector<AttemptData> attempts;
};

struct ReportData {
  std::string name;
  std::string title;
  std::string made_at;  ///< date and time for people
  ReportSettings settings;
  std::vector<Recording> recordings;
  std::vector<RecordedSeries> recorded_series;
  std::vector<RunData> runs;
  std::vector<std::pair<std::string, std::string>> provenance;  ///< name and value, as shown
  std::vector<std::string> warnings;                            ///< what could not be read
};

}  // namespace grouser
