// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "campaign/report/report_data.hpp"
#include "campaign/report/statistics.hpp"

namespace grouser {

/// Rows of a series over which means are taken: the last `average_travel` of the driven travel.
struct Window {
  std::size_t first = 0;     ///< first row
  std::size_t end = 0;       ///< one after the last row
  double from_travel = 0.0;  ///< [m]
  double to_travel = 0.0;    ///< where it ends, reached or not [m]
  double from_time = kNaN;   ///< simulated time of its rows; NaN when there are none [s]
  double to_time = kNaN;
  bool is_complete = false;  ///< the travel has reached the window's end

  std::size_t rows() const { return end - first; }
};

/// @param is_finished the run has ended for good: its window then ends where its travel does
/// (a run may end early at a steady state), else at the travel the case asks for. Local.
Window averaging_window(const RunSeries& series, const WheelCase& wheel, bool is_finished);

/// Means of one run over its window.
struct RunResult {
  std::size_t run = 0;  ///< index into ReportData::runs
  Window window;
  Estimate slip;  ///< measured, in the report's definition [1]
  std::array<Estimate, kObservableCount> means;

  const Estimate& of(Observable o) const { return means[index_of(o)]; }
};

/// Runs that differ only on the scatter axis.
struct PointResult {
  std::string label;
  bool is_towed = false;
  std::vector<std::size_t> runs;  ///< all of them, indices into ReportData::runs
  std::size_t complete = 0;       ///< runs with a complete window, the only ones averaged
  Scatter slip;
  std::array<Scatter, kObservableCount> observables;
  /// Standard deviation by which a single run may be off by chance: between seeds, or that of the
  /// means within the runs where it is larger (two seeds may agree by chance) or where there is
  /// one run. NaN = unknown.
  std::array<double, kObservableCount> chance;

  const Scatter& of(Observable o) const { return observables[index_of(o)]; }
  double chance_of(Observable o) const { return chance[index_of(o)]; }
};

/// How a campaign value was found for a recorded one.
enum class Match {
  kNone,          ///< the campaign has nothing there (yet)
  kTowed,         ///< towed beside towed
  kSlip,          ///< a point at the same slip, within 1 %
  kInterpolated,  ///< linear between the two neighbouring points
};
const char* word_of(Match match);

/// A recorded value beside the campaign's. SI units.
struct Comparison {
  std::size_t recording = 0;  ///< index into ReportData::recordings
  std::size_t point = 0;      ///< index into Recording::points
  Match match = Match::kNone;
  std::string label;   ///< of the campaign's point, or both of them
  double slip = kNaN;  ///< recorded, in the report's definition; towed: the campaign's
  double campaign = kNaN;
  double chance = kNaN;      ///< see PointResult; NaN = unknown
  double tolerance = kNaN;   ///< 2 sqrt(chance^2 + uncertainty^2), unknown uncertainty as 0
  double difference = kNaN;  ///< campaign - recorded

  bool is_known() const { return match != Match::kNone; }
  bool is_inside() const { return difference <= tolerance && -difference <= tolerance; }
};

struct Analysis {
  SlipDefinition slip_definition = SlipDefinition::kPowered;
  std::vector<RunResult> runs;  ///< wheel runs, in the order of ReportData::runs
  std::vector<PointResult> points;
  std::vector<Comparison> comparisons;

  const RunResult* result_of(std::size_t run) const;
};

/// Local.
Analysis analyse(const ReportData& data);

}  // namespace grouser
