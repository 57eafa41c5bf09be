// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <utility>

#include "campaign/report/figures.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/sections.hpp"

namespace grouser {
namespace {

constexpr std::array kSignals{std::pair{TrackSignal::kGap, "gap [mm]"},
                              std::pair{TrackSignal::kVelocity, "speed [mm/s]"}};

std::string difference_table(const ReportData& data) {
  HtmlTable table("Recorded series beside the tracked grain");
  table.header({"Run", "Signal", "Recorded points", "Root mean square difference", "Use"},
               {false, false, true, true, false});
  for (const RunData& run : data.runs)
    for (const auto& [signal, name] : kSignals)
      for (const RecordedCurve* curve : curves_of(data, run, signal))
        if (!run.track.time.empty())
          table.row({escape_html(run.label), name, std::to_string(curve->time.size()),
                     shown_significant(rms_difference(run.track, signal, *curve), 3),
                     curve->is_held_out ? "held out" : "fit"});
  return table.rows() > 0 ? table.html() : "";
}

std::string sources(const ReportData& data) {
  std::string text;
  for (const RecordedSeries& recording : data.recorded_series)
    text += "<p class=\"note\">" +
            escape_html(recording.title + ". " + recording.citation +
                        ". Licence: " + recording.licence + ".") +
            "</p>\n";
  return text;
}

}  // namespace

std::string tracks_section(const ReportData& data) {
  std::string cards;
  for (const RunData& run : data.runs) {
    if (run.track.time.size() < 2) continue;
    cards += "<article class=\"card run\" data-run=\"" + escape_html(run.label) +
             "\">\n<header><h3>" + escape_html(run.label) + "</h3>" + state_badge(run.state) +
             "</header>\n";
    for (const auto& [signal, name] : kSignals) cards += track_figure(data, run, signal);
    cards += "</article>\n";
  }
  if (cards.empty()) return "";
  return section("tracks", "Tracked grains",
                 difference_table(data) + "<div class=\"grid runs\">\n" + cards + "</div>\n" +
                     "<p class=\"note\">Line: the engine's grain. Diamonds: recorded, at the "
                     "recording's own time; the condition is the one named as the run's point of "
                     "a sweep axis. Nothing is shifted or fitted.</p>\n" +
                     sources(data));
}

}  // namespace grouser
