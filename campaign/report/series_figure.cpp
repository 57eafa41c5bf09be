// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <vector>

#include "campaign/report/figures.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/plot.hpp"

namespace grouser {
namespace {

constexpr std::size_t kColumns = 220;

struct Curve {
  Observable observable;
  const char* css_class;
};

std::vector<PlotPoint> points_of(const RunSeries& series, Observable observable) {
  std::vector<PlotPoint> points;
  for (std::size_t i = 0; i < series.size(); ++i)
    points.emplace_back(series.time[i],
                        entry_of(observable).shown_scale * series.of(observable)[i]);
  return thin_curve(points, kColumns);
}

PlotAxis vertical_axis(const RunSeries& series, const std::vector<Curve>& curves) {
  ValueRange range;
  range.add(0.0);
  for (const Curve& curve : curves)
    for (const double value : series.of(curve.observable))
      range.add(entry_of(curve.observable).shown_scale * value);
  return nice_axis(range.low(), range.is_empty() ? 1.0 : range.high(), 4);
}

std::string describe_curves(const RunResult& result, const std::vector<Curve>& curves) {
  std::string text;
  for (const Curve& curve : curves) {
    const ObservableEntry& entry = entry_of(curve.observable);
    const Estimate& mean = result.of(curve.observable);
    text += std::string(entry.heading) + " mean " +
            shown_number(entry.shown_scale * mean.mean, entry.shown_decimals) + " ± " +
            shown_number(entry.shown_scale * mean.error, entry.shown_decimals) + " " +
            entry.shown_unit + ". ";
  }
  return text;
}

std::string figure(const RunData& run, const RunResult& result, const std::vector<Curve>& curves,
                   const std::string& y_label, double height) {
  ValueRange times;
  times.add(0.0);
  times.add(run.series.time);
  if (!run.is_finished) times.add(run.end_time);
  Plot plot(run.label + ": " + y_label + " over time", describe_curves(result, curves),
            nice_axis(times.low(), times.high(), 5), vertical_axis(run.series, curves),
            "Simulated time [s]", y_label);
  plot.set_height(height);
  const Window& window = result.window;
  plot.shade(window.from_time, window.to_time, {"window", "window"},
             "Averaging window: travel " + shown_number(100.0 * window.from_travel, 1) + " to " +
                 shown_number(100.0 * window.to_travel, 1) + " cm");
  plot.zero_line();
  for (const Curve& curve : curves) {
    const ObservableEntry& entry = entry_of(curve.observable);
    plot.line(points_of(run.series, curve.observable),
              {std::string("trace ") + curve.css_class, entry.name});
    const double mean = entry.shown_scale * result.of(curve.observable).mean;
    plot.line({{window.from_time, mean}, {window.to_time, mean}},
              {std::string("window_mean ") + curve.css_class, ""});
  }
  return plot.svg();
}

}  // namespace

std::string coefficient_figure(const RunData& run, const RunResult& result) {
  return figure(run, result,
                {{Observable::kGrossCoefficient, "gross"}, {Observable::kPullCoefficient, "pull"}},
                "Pull and gross coefficient [%]", 250.0);
}

std::string sinkage_figure(const RunData& run, const RunResult& result) {
  return figure(run, result, {{Observable::kSinkage, "sinkage"}}, "Sinkage [mm]", 190.0);
}

}  // namespace grouser
