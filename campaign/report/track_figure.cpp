// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "campaign/report/figures.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/plot.hpp"

namespace grouser {
namespace {

constexpr std::size_t kColumns = 220;

// Gap in mm, or downward speed in mm/s.
double shown(TrackSignal signal, double value) {
  return signal == TrackSignal::kGap ? 1e3 * value : -1e3 * value;
}

double shown_recorded(const RecordedCurve& curve, double value) {
  return curve.channel == "vertical_velocity" ? -1e3 * value : 1e3 * value;
}

bool is_of(const RecordedCurve& curve, TrackSignal signal) {
  return (curve.channel == "gap") == (signal == TrackSignal::kGap);
}

const std::vector<double>& values_of(const TrackSeries& track, TrackSignal signal) {
  return signal == TrackSignal::kGap ? track.gap : track.velocity;
}

}  // namespace

std::vector<const RecordedCurve*> curves_of(const ReportData& data, const RunData& run,
                                            TrackSignal signal) {
  std::vector<const RecordedCurve*> curves;
  for (const RecordedSeries& recording : data.recorded_series)
    for (const RecordedCurve& curve : recording.curves)
      if (is_of(curve, signal) &&
          std::any_of(run.axes.begin(), run.axes.end(),
                      [&](const auto& axis) { return axis.second == curve.condition; }))
        curves.push_back(&curve);
  return curves;
}

double rms_difference(const TrackSeries& track, TrackSignal signal, const RecordedCurve& curve) {
  const std::vector<double>& values = values_of(track, signal);
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < curve.time.size(); ++i) {
    const auto above = std::upper_bound(track.time.begin(), track.time.end(), curve.time[i]);
    if (above == track.time.begin() || above == track.time.end()) continue;
    const auto k = static_cast<std::size_t>(above - track.time.begin());
    const double part = (curve.time[i] - track.time[k - 1]) / (track.time[k] - track.time[k - 1]);
    const double value = values[k - 1] + part * (values[k] - values[k - 1]);
    const double difference = shown(signal, value) - shown_recorded(curve, curve.value[i]);
    sum += difference * difference;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : NAN;
}

std::string track_figure(const ReportData& data, const RunData& run, TrackSignal signal) {
  const std::vector<double>& values = values_of(run.track, signal);
  const std::string label =
      signal == TrackSignal::kGap ? "Gap to the floor [mm]" : "Downward speed [mm/s]";
  const auto recorded = curves_of(data, run, signal);
  std::vector<PlotPoint> line;
  ValueRange times;
  ValueRange range;
  range.add(0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    line.emplace_back(run.track.time[i], shown(signal, values[i]));
    range.add(line.back().second);
  }
  times.add(run.track.time);
  for (const RecordedCurve* curve : recorded) {
    times.add(curve->time);
    for (const double value : curve->value) range.add(shown_recorded(*curve, value));
  }
  Plot plot(run.label + ": " + label + " over time",
            recorded.empty() ? "No recording." : "Line: engine. Diamonds: recording.",
            nice_axis(times.low(), times.high(), 5), nice_axis(range.low(), range.high(), 4),
            "Time [s]", label);
  plot.zero_line();
  plot.line(thin_curve(line, kColumns), {"trace pull", "engine"});
  for (const RecordedCurve* curve : recorded)
    for (std::size_t i = 0; i < curve->time.size(); ++i) {
      const PlotPoint at{curve->time[i], shown_recorded(*curve, curve->value[i])};
      if (curve->noise > 0.0) plot.error_bar(at, 1e3 * curve->noise, {"lab", ""});
      plot.marker(at, Marker::kDiamond, {"lab", "recorded"},
                  curve->condition + " recorded: " + shown_significant(at.second, 4) + " at " +
                      shown_significant(at.first, 4) + " s");
    }
  return plot.svg();
}

}  // namespace grouser
