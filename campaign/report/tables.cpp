// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/tables.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "campaign/report/csv.hpp"
#include "campaign/report/words.hpp"

namespace grouser {
namespace {

std::string with_unit(const std::string& name, const char* unit) {
  return name + " [" + unit + "]";
}

/// Axes of all runs in order of appearance; all runs of one campaign have the same.
std::vector<std::string> axes_of(const ReportData& data) {
  std::vector<std::string> axes;
  for (const RunData& run : data.runs)
    for (const auto& [axis, label] : run.axes)
      if (std::find(axes.begin(), axes.end(), axis) == axes.end()) axes.push_back(axis);
  return axes;
}

std::string label_on(const RunData& run, const std::string& axis) {
  for (const auto& [name, label] : run.axes)
    if (name == axis) return label;
  return "";
}

void results_header(CsvWriter& csv, const std::vector<std::string>& axes) {
  for (const char* const name : {"run", "key", "state"}) csv.cell(std::string(name));
  for (const std::string& axis : axes) csv.cell("axis:" + axis);
  for (const char* const name : {"window_from [m]", "window_to [m]", "window_rows [1]",
                                 "window_complete", "slip [1]", "slip_error [1]"})
    csv.cell(std::string(name));
  for (const ObservableEntry& entry : kObservables) {
    csv.cell(with_unit(entry.name, entry.unit));
    csv.cell(with_unit(std::string(entry.name) + "_error", entry.unit));
    csv.cell(with_unit(std::string(entry.name) + "_drift", entry.unit));
  }
  csv.cell(std::string("time [s]"));
  csv.cell(std::string("particles [1]"));
  csv.cell(std::string("state_hash"));
  csv.end_row();
}

std::string verdict_of(const Comparison& comparison) {
  if (!std::isfinite(comparison.tolerance) || !comparison.is_known()) return "unknown";
  return comparison.is_inside() ? "yes" : "no";
}

/// Shown value with sign and unit, "-" when there is none.
std::string shown(const ObservableEntry& entry, double value) {
  if (!std::isfinite(value)) return "-";
  return fmt::format("{:.{}f}", value * entry.shown_scale, entry.shown_decimals);
}

std::string shown_with_scatter(const ObservableEntry& entry, double mean, double chance) {
  if (!std::isfinite(mean) || !std::isfinite(chance)) return shown(entry, mean);
  return shown(entry, mean) + " ± " + shown(entry, chance);
}

/// Pads to `width` columns, counting characters and not bytes.
std::string padded(const std::string& text, std::size_t width) {
  const auto is_start = [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; };
  const auto count = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_start));
  return count >= width ? text : text + std::string(width - count, ' ');
}

constexpr std::array<Observable, 3> kSummaryColumns{
    Observable::kPullCoefficient, Observable::kGrossCoefficient, Observable::kSinkage};

std::string summary_points(const Analysis& analysis) {
  std::size_t width = 14;
  for (const PointResult& point : analysis.points) width = std::max(width, point.label.size() + 2);
  std::string text = padded("point", width) + padded("runs", 8) + padded("slip %", 10);
  for (const Observable o : kSummaryColumns)
    text += padded(std::string(o == Observable::kPullCoefficient    ? "pull"
                               : o == Observable::kGrossCoefficient ? "gross"
                                                                    : "sinkage") +
                       " " + entry_of(o).shown_unit,
                   17);
  text += "\n";
  for (const PointResult& point : analysis.points) {
    text += padded(point.label, width) +
            padded(fmt::format("{}/{}", point.complete, point.runs.size()), 8) +
            padded(std::isfinite(point.slip.mean) ? fmt::format("{:.1f}", 100.0 * point.slip.mean)
                                                  : "-",
                   10);
    for (const Observable o : kSummaryColumns)
      text += padded(shown_with_scatter(entry_of(o), point.of(o).mean, point.chance_of(o)), 17);
    text += "\n";
  }
  return text;
}

std::string summary_comparisons(const ReportData& data, const Analysis& analysis) {
  if (analysis.comparisons.empty()) return "";
  std::string text = "\n" + padded("recorded", 14) + padded("kind", 11) + padded("value", 35) +
                     padded("recorded", 12) + padded("campaign", 12) + "inside scatter\n";
  for (const Comparison& c : analysis.comparisons) {
    const RecordingPoint& point = data.recordings[c.recording].points[c.point];
    const ObservableEntry& entry = entry_of(point.observable);
    text += padded(point.condition, 14) + padded(point.kind, 11) +
            padded(std::string(entry.heading) + " " + entry.shown_unit, 35) +
            padded(shown(entry, point.value), 12) + padded(shown(entry, c.campaign), 12) +
            verdict_of(c) + "\n";
  }
  return text;
}

}  // namespace

std::string results_csv(const ReportData& data, const Analysis& analysis) {
  const std::vector<std::string> axes = axes_of(data);
  CsvWriter csv;
  results_header(csv, axes);
  for (const RunResult& result : analysis.runs) {
    const RunData& run = data.runs[result.run];
    for (const std::string& text : {run.label, run.key, run.state}) csv.cell(text);
    for (const std::string& axis : axes) csv.cell(label_on(run, axis));
    csv.cell(result.window.from_travel);
    csv.cell(result.window.to_travel);
    csv.cell(result.window.rows());
    csv.cell(std::string(result.window.is_complete ? "yes" : "no"));
    csv.cell(result.slip.mean);
    csv.cell(result.slip.error);
    for (const Estimate& mean : result.means) {
      csv.cell(mean.mean);
      csv.cell(mean.error);
      csv.cell(mean.drift);
    }
    csv.cell(run.time);
    csv.cell(static_cast<std::size_t>(run.particles));
    csv.cell(run.state_hash);
    csv.end_row();
  }
  return csv.text();
}

std::string means_csv(const Analysis& analysis) {
  CsvWriter csv;
  for (const char* const name :
       {"point", "towed", "runs [1]", "runs_averaged [1]", "slip [1]", "slip_deviation [1]"})
    csv.cell(std::string(name));
  for (const ObservableEntry& entry : kObservables)
    for (const char* const part : {"", "_deviation", "_low", "_high", "_chance"})
      csv.cell(with_unit(std::string(entry.name) + part, entry.unit));
  csv.end_row();
  for (const PointResult& point : analysis.points) {
    csv.cell(point.label);
    csv.cell(std::string(point.is_towed ? "yes" : "no"));
    csv.cell(point.runs.size());
    csv.cell(point.complete);
    csv.cell(point.slip.mean);
    csv.cell(point.slip.deviation);
    for (const ObservableEntry& entry : kObservables) {
      const Scatter& scatter = point.of(entry.id);
      for (const double value :
           {scatter.mean, scatter.deviation, scatter.low, scatter.high, point.chance_of(entry.id)})
        csv.cell(value);
    }
    csv.end_row();
  }
  return csv.text();
}

std::string compare_csv(const ReportData& data, const Analysis& analysis) {
  CsvWriter csv;
  for (const char* const name : {"recording", "condition", "kind", "observable", "unit", "match",
                                 "campaign_point", "slip [1]", "recorded", "uncertainty",
                                 "campaign", "chance", "difference", "tolerance", "inside"})
    csv.cell(std::string(name));
  csv.end_row();
  for (const Comparison& c : analysis.comparisons) {
    const Recording& recording = data.recordings[c.recording];
    const RecordingPoint& point = recording.points[c.point];
    const ObservableEntry& entry = entry_of(point.observable);
    for (const std::string& text :
         {recording.name, point.condition, point.kind, std::string(entry.name),
          std::string(entry.unit), std::string(word_of(c.match)), c.label})
      csv.cell(text);
    for (const double value :
         {c.slip, point.value, point.uncertainty, c.campaign, c.chance, c.difference, c.tolerance})
      csv.cell(value);
    csv.cell(verdict_of(c));
    csv.end_row();
  }
  return csv.text();
}

std::string summary_text(const ReportData& data, const Analysis& analysis) {
  const std::string drift = drift_in_words(analysis);
  return summary_points(analysis) + (drift.empty() ? "" : drift + "\n") +
         summary_comparisons(data, analysis);
}

}  // namespace grouser
