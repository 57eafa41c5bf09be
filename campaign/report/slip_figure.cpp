// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include "campaign/report/figures.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/plot.hpp"

namespace grouser {
namespace {

/// Draws one observable over slip; values are in the units shown.
class SlipFigure {
 public:
  SlipFigure(const ReportData& data, const Analysis& analysis, Observable observable)
      : data_(data), analysis_(analysis), entry_(entry_of(observable)) {
    for (const PointResult& point : analysis.points)
      if (!point.is_towed && point.complete > 0) curve_.push_back(&point);
    std::sort(curve_.begin(), curve_.end(), [](const PointResult* a, const PointResult* b) {
      return a->slip.mean < b->slip.mean;
    });
  }

  std::string svg() const {
    Plot plot(std::string(entry_.heading) + " over slip", description(), x_axis(), y_axis(),
              std::string("Slip ") + formula_of(analysis_.slip_definition) + " [%]",
              std::string(entry_.heading) + " [" + entry_.shown_unit + "]");
    plot.zero_line();
    draw_curve(plot);
    draw_runs(plot);
    draw_towed(plot);
    draw_recorded(plot);
    return plot.svg();
  }

 private:
  double shown(double value) const { return value * entry_.shown_scale; }
  double mean_of(const PointResult& point) const { return shown(point.of(entry_.id).mean); }
  double chance_of(const PointResult& point) const {
    const double chance = shown(point.chance_of(entry_.id));
    return std::isfinite(chance) ? chance : 0.0;
  }
  const RecordingPoint& recorded(const Comparison& c) const {
    return data_.recordings[c.recording].points[c.point];
  }
  bool is_here(const Comparison& c) const { return recorded(c).observable == entry_.id; }
  std::string text_of(double value) const {
    return shown_number(value, entry_.shown_decimals) + " " + entry_.shown_unit;
  }

  PlotAxis x_axis() const {
    ValueRange range;
    for (const RunResult& run : analysis_.runs) range.add(100.0 * run.slip.mean);
    for (const Comparison& c : analysis_.comparisons)
      if (is_here(c)) range.add(100.0 * c.slip);
    return nice_axis(range.low(), range.is_empty() ? 100.0 : range.high(), 6);
  }

  PlotAxis y_axis() const {
    ValueRange range;
    range.add(0.0);
    for (const RunResult& run : analysis_.runs) range.add(shown(run.of(entry_.id).mean));
    for (const PointResult& point : analysis_.points)
      for (const double side : {-1.0, 1.0}) range.add(mean_of(point) + side * chance_of(point));
    for (const Comparison& c : analysis_.comparisons) {
      if (!is_here(c) || !std::isfinite(c.slip)) continue;
      const double bar = std::isfinite(recorded(c).uncertainty) ? recorded(c).uncertainty : 0.0;
      for (const double side : {-1.0, 1.0}) range.add(shown(recorded(c).value + side * bar));
    }
    return nice_axis(range.low(), range.high(), 5);
  }

  std::string description() const {
    std::string text;
    for (const PointResult& point : analysis_.points)
      if (point.complete > 0)
        text += point.label + ": " + text_of(mean_of(point)) + " at slip " +
                shown_number(100.0 * point.slip.mean, 1) + " %. ";
    return text.empty() ? "No run has reached its averaging window yet." : text;
  }

  void draw_curve(Plot& plot) const {
    std::vector<PlotPoint> means;
    std::vector<PlotPoint> low;
    std::vector<PlotPoint> high;
    for (const PointResult* point : curve_) {
      const double slip = 100.0 * point->slip.mean;
      if (!std::isfinite(slip) || !std::isfinite(mean_of(*point))) continue;
      means.emplace_back(slip, mean_of(*point));
      low.emplace_back(slip, mean_of(*point) - chance_of(*point));
      high.emplace_back(slip, mean_of(*point) + chance_of(*point));
    }
    plot.band(low, high, {"band", "scatter"});
    plot.line(means, {"mean", "mean"});
  }

  void draw_runs(Plot& plot) const {
    for (const RunResult& result : analysis_.runs) {
      const RunData& run = data_.runs[result.run];
      const bool is_complete = result.window.is_complete;
      const double value = shown(result.of(entry_.id).mean);
      plot.marker({100.0 * result.slip.mean, value}, Marker::kDot,
                  {is_complete ? "seed" : "seed partial", is_complete ? "run" : "partial-run"},
                  run.label + ": " + text_of(value) +
                      (is_complete ? "" : " (averaging window not complete)"));
    }
  }

  void draw_towed(Plot& plot) const {
    for (const PointResult& point : analysis_.points) {
      if (!point.is_towed || point.complete == 0) continue;
      const PlotPoint at{100.0 * point.slip.mean, mean_of(point)};
      plot.error_bar(at, chance_of(point), {"bar campaign", ""});
      plot.marker(at, Marker::kRing, {"towed", "towed"},
                  point.label + ", free rotation: " + text_of(at.second) + " at slip " +
                      shown_number(at.first, 1) + " %");
    }
  }

  void draw_recorded(Plot& plot) const {
    for (const Comparison& c : analysis_.comparisons) {
      if (!is_here(c)) continue;
      const RecordingPoint& point = recorded(c);
      const bool is_lab = point.kind == "lab";
      const PlotPoint at{100.0 * c.slip, shown(point.value)};
      const std::string css = is_lab ? "lab" : "paper";
      plot.error_bar(at, shown(point.uncertainty), {"bar " + css, ""});
      plot.marker(at, is_lab ? Marker::kDiamond : Marker::kSquare, {css, point.kind},
                  std::string(is_lab ? "Laboratory, " : "Published simulation, ") +
                      point.condition + ": " + text_of(at.second));
    }
  }

  const ReportData& data_;
  const Analysis& analysis_;
  const ObservableEntry& entry_;
  std::vector<const PointResult*> curve_;
};

std::string legend_item(const std::string& drawing, const std::string& text) {
  return "<li><svg viewBox=\"0 0 26 18\" aria-hidden=\"true\">" + drawing + "</svg>" +
         escape_html(text) + "</li>\n";
}

}  // namespace

std::string slip_figure(const ReportData& data, const Analysis& analysis, Observable observable) {
  return SlipFigure(data, analysis, observable).svg();
}

std::string slip_legend(const ReportData& data, const Analysis& analysis) {
  const auto has_kind = [&](const char* kind) {
    for (const Recording& recording : data.recordings)
      for (const RecordingPoint& point : recording.points)
        if (point.kind == kind) return true;
    return false;
  };
  const bool has_towed = std::any_of(analysis.points.begin(), analysis.points.end(),
                                     [](const PointResult& point) { return point.is_towed; });
  std::string items =
      legend_item("<path class=\"band\" d=\"M0 3H26V15H0Z\"/><path class=\"mean\" d=\"M0 9H26\"/>",
                  "mean of the runs, ± one standard deviation") +
      legend_item(marker_svg(13, 9, Marker::kDot, {"seed", ""}, ""), "one run");
  const bool has_partial =
      std::any_of(analysis.runs.begin(), analysis.runs.end(), [](const RunResult& result) {
        return !result.window.is_complete && result.window.rows() > 0;
      });
  if (has_partial)
    items += legend_item(marker_svg(13, 9, Marker::kDot, {"seed partial", ""}, ""),
                         "run before the end of its window, not averaged");
  if (has_towed)
    items += legend_item(marker_svg(13, 9, Marker::kRing, {"towed", ""}, ""),
                         "towed, at its measured slip");
  if (has_kind("lab"))
    items += legend_item(marker_svg(13, 9, Marker::kDiamond, {"lab", ""}, ""), "laboratory");
  if (has_kind("paper_dem"))
    items +=
        legend_item(marker_svg(13, 9, Marker::kSquare, {"paper", ""}, ""), "published simulation");
  return "<ul class=\"legend\">\n" + items + "</ul>\n";
}

}  // namespace grouser
