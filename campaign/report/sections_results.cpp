// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "campaign/report/figures.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/sections.hpp"

namespace grouser {
namespace {

constexpr std::array<Observable, 3> kCurves{Observable::kPullCoefficient,
                                            Observable::kGrossCoefficient, Observable::kSinkage};
constexpr std::size_t kMostPictures = 12;

std::string with_scatter(const ObservableEntry& entry, double mean, double chance) {
  std::string text = shown_number(entry.shown_scale * mean, entry.shown_decimals);
  if (std::isfinite(mean) && std::isfinite(chance))
    text +=
        " <small>± " + shown_number(entry.shown_scale * chance, entry.shown_decimals) + "</small>";
  return text;
}

std::string percent(double share) { return shown_number(100.0 * share, 1); }

std::string verdict_html(const Comparison& c) {
  if (!c.is_known()) return "<span class=\"muted\">no counterpart</span>";
  if (!std::isfinite(c.tolerance)) return "<span class=\"muted\">scatter unknown</span>";
  return c.is_inside() ? "<span class=\"badge good\">inside</span>"
                       : "<span class=\"badge off\">outside</span>";
}

std::vector<std::string> comparison_row(const ReportData& data, const Comparison& c) {
  const RecordingPoint& point = data.recordings[c.recording].points[c.point];
  const ObservableEntry& entry = entry_of(point.observable);
  const std::string sign = c.difference > 0.0 ? "+" : "";
  const bool is_lab = point.kind == "lab";
  return {escape_html(point.condition),
          is_lab ? "laboratory" : "published simulation",
          std::string(entry.heading) + " <small>[" + entry.shown_unit + "]</small>",
          percent(c.slip),
          with_scatter(entry, point.value, point.uncertainty),
          with_scatter(entry, c.campaign, c.chance),
          sign + shown_number(entry.shown_scale * c.difference, entry.shown_decimals),
          shown_number(entry.shown_scale * c.tolerance, entry.shown_decimals),
          verdict_html(c),
          escape_html(c.label) +
              (c.match == Match::kInterpolated ? " <small>interpolated</small>" : "")};
}

std::string drift_html(const ObservableEntry& entry, double drift) {
  return "<br/><small class=\"drift\">" + std::string(drift > 0.0 ? "rises" : "falls") + " by " +
         shown_number(std::abs(entry.shown_scale * drift), entry.shown_decimals) +
         " in the window</small>";
}

/// Key figures of one run beside its curves.
std::string run_figures(const RunData& run, const RunResult& result) {
  std::string text = "<dl class=\"figures\">";
  const auto add = [&](const std::string& name, const std::string& value) {
    text += "<div><dt>" + name + "</dt><dd>" + value + "</dd></div>";
  };
  for (const Observable o : kCurves) {
    const ObservableEntry& entry = entry_of(o);
    const Estimate& mean = result.of(o);
    add(entry.heading, with_scatter(entry, mean.mean, mean.error) + " " + entry.shown_unit +
                           (mean.is_drifting() ? drift_html(entry, mean.drift) : std::string()));
  }
  add("Slip", percent(result.slip.mean) + " %");
  add("Simulated",
      shown_significant(run.time, 3) +
          (run.end_time > 0.0 ? " of " + shown_significant(run.end_time, 3) : std::string()) +
          " s");
  add("Grains", run.particles > 0 ? shown_count(run.particles) : "–");
  return text + "</dl>\n";
}

std::string run_card(const RunData& run, const RunResult* result) {
  std::string body =
      "<header><h3>" + escape_html(run.label) + "</h3>" + state_badge(run.state) + "</header>\n";
  if (!run.reason.empty() && !run.is_finished)
    body += "<p class=\"reason\">" + escape_html(run.reason) + "</p>\n";
  if (run.series.size() < 2) {
    body += "<p class=\"muted\">No time series yet.</p>\n";
  } else {
    body += coefficient_figure(run, *result) + sinkage_figure(run, *result);
    if (!result->window.is_complete)
      body +=
          "<p class=\"muted\">The averaging window is not complete; this run is not part of the "
          "means.</p>\n";
  }
  return "<article class=\"card run\" data-run=\"" + escape_html(run.label) + "\">\n" + body +
         run_figures(run, *result) + "</article>\n";
}

/// The run of a point that is shown as a picture: its first one that has grains.
const RunData* pictured_run(const ReportData& data, const PointResult& point) {
  for (const std::size_t run : point.runs)
    if (!data.runs[run].slice.grains.empty()) return &data.runs[run];
  return nullptr;
}

}  // namespace

std::string curves_section(const ReportData& data, const Analysis& analysis) {
  if (analysis.runs.empty()) return "";
  std::string body = slip_legend(data, analysis) + "<div class=\"grid curves\">\n";
  for (const Observable observable : kCurves)
    body += "<figure class=\"card\">" + slip_figure(data, analysis, observable) + "</figure>\n";
  body +=
      "</div>\n<p class=\"note\">Means over the last part of the travel (the shaded windows "
      "below). "
      "Pull and gross coefficient are drawbar pull and gross tractive effort over the wheel load. "
      "Positive are: pull forward, gross when the axle must be driven, sinkage downward.</p>\n";
  return section("curves", "Curves over slip", body);
}

std::string comparison_section(const ReportData& data, const Analysis& analysis) {
  if (analysis.comparisons.empty()) return "";
  HtmlTable table("Recorded values beside the campaign");
  table.header({"Condition", "Source", "Observable", "Slip&#160;[%]", "Recorded", "Campaign",
                "Difference", "2&#160;σ", "Seed scatter", "Campaign point"},
               {false, false, false, true, true, true, true, true, false, false});
  for (const Comparison& c : analysis.comparisons) table.row(comparison_row(data, c));
  return section(
      "comparison", "Beside the recordings",
      table.html() +
          "<p class=\"note\">Inside the seed scatter: the difference is at most 2 σ. σ is the "
          "standard "
          "deviation between seeds, or the error of the means within the runs where that is "
          "larger; "
          "the recording's own uncertainty is added in squares where it is known. Differences of "
          "coefficients are in percentage points.</p>\n");
}

std::string points_section(const ReportData& data, const Analysis& analysis) {
  if (analysis.points.empty()) return "";
  HtmlTable table("Means per point of the sweep");
  std::vector<std::string> names{"Point", "Runs", "Slip&#160;[%]"};
  std::vector<bool> numbers{false, true, true};
  for (const ObservableEntry& entry : kObservables) {
    names.push_back(std::string(entry.heading) + "&#160;[" + entry.shown_unit + "]");
    numbers.push_back(true);
  }
  table.header(names, numbers);
  for (const PointResult& point : analysis.points) {
    std::vector<std::string> cells{
        escape_html(point.label) + (point.is_towed ? " <small>free rotation</small>" : ""),
        std::to_string(point.complete) + "/" + std::to_string(point.runs.size()),
        percent(point.slip.mean)};
    for (const ObservableEntry& entry : kObservables)
      cells.push_back(with_scatter(entry, point.of(entry.id).mean, point.chance_of(entry.id)));
    table.row(cells);
  }
  return section(
      "points", "Means",
      table.html() +
          "<p class=\"note\">Runs: averaged over those planned; they differ on the "
          "axis “" +
          escape_html(data.settings.scatter_axis) +
          "” only. ± is one standard deviation, as under the comparison. The same numbers, "
          "unrounded and in SI units, are in <code>results.csv</code>, "
          "<code>means.csv</code> and <code>compare.csv</code> beside this file.</p>\n");
}

std::string pictures_section(const ReportData& data, const Analysis& analysis) {
  const double scale = displacement_scale(data);
  if (!(scale > 0.0)) return "";
  std::string pictures;
  std::size_t drawn = 0;
  std::size_t left_out = 0;
  for (const PointResult& point : analysis.points) {
    const RunData* run = pictured_run(data, point);
    if (run == nullptr) continue;
    if (drawn == kMostPictures) {
      ++left_out;
      continue;
    }
    ++drawn;
    pictures += "<figure class=\"card\">" + bed_figure(*run, scale) + "<figcaption><b>" +
                escape_html(run->label) + "</b> box " +
                shown_number(100.0 * run->slice.box_length, 1) + " cm long" +
                (run->slice.every > 1
                     ? ", 1 grain in " + std::to_string(run->slice.every) + " drawn, enlarged"
                     : std::string()) +
                "</figcaption></figure>\n";
  }
  return section(
      "pictures", "Bed and wheel",
      displacement_legend(scale) + "<div class=\"grid pictures\">\n" + pictures +
          "</div>\n<p class=\"note\">Side view at the end of the newest attempt, driving to the "
          "right: grains within a quarter of the wheel's width of the mid-plane, the more "
          "displaced drawn over the less displaced." +
          (left_out > 0 ? " " + std::to_string(left_out) + " more points are not drawn."
                        : std::string()) +
          "</p>\n");
}

std::string runs_section(const ReportData& data, const Analysis& analysis) {
  if (analysis.runs.empty()) return "";
  std::string cards;
  for (const RunResult& result : analysis.runs) cards += run_card(data.runs[result.run], &result);
  return section("runs", "Runs over time",
                 "<ul class=\"legend\"><li><i class=\"swatch pull\"></i>pull coefficient</li>"
                 "<li><i class=\"swatch gross\"></i>gross coefficient</li>"
                 "<li><i class=\"swatch sinkage\"></i>sinkage</li>"
                 "<li><i class=\"swatch window\"></i>averaging window, with its mean</li></ul>\n"
                 "<div class=\"grid runs\">\n" +
                     cards + "</div>\n");
}

}  // namespace grouser
