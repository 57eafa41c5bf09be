// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>

#include "campaign/report/html.hpp"
#include "campaign/report/parameters.hpp"
#include "campaign/report/sections.hpp"

namespace grouser {
namespace {

/// The values a key takes over the runs, in order of appearance.
struct Column {
  Parameter first;
  std::vector<std::string> values;
};

std::vector<Column> columns_of(const ReportData& data) {
  std::vector<Column> columns;
  std::map<std::string, std::size_t> at;
  for (const RunData& run : data.runs) {
    if (run.is_bed || !run.has_case) continue;
    for (const Parameter& parameter : parameters_of(run.input)) {
      const auto [entry, is_new] = at.emplace(parameter.key, columns.size());
      if (is_new) columns.push_back({parameter, {}});
      std::vector<std::string>& values = columns[entry->second].values;
      if (std::find(values.begin(), values.end(), parameter.value) == values.end())
        values.push_back(parameter.value);
    }
  }
  return columns;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + text;
  return all;
}

std::string folded(const std::string& summary, const std::string& body) {
  return "<details><summary>" + summary + "</summary>\n" + body + "</details>\n";
}

/// Speed of an attempt in particle-steps per second of computing.
std::string speed_of(const AttemptData& attempt) {
  if (!(attempt.compute_seconds > 0.0) || attempt.steps_done <= 0) return "–";
  const double speed = static_cast<double>(attempt.steps_done) *
                       static_cast<double>(attempt.particles) / attempt.compute_seconds;
  return shown_significant(speed / 1e6, 3);
}

std::string seconds_cell(double seconds) { return seconds > 0.0 ? shown_number(seconds, 1) : "–"; }

std::string hash_cell(const std::string& hash) {
  return hash.empty() ? "–" : "<code>" + escape_html(hash) + "</code>";
}

std::string apparatus_row(const std::string& name, double recorded, double campaign, double scale,
                          int decimals, const std::string& unit) {
  return "<tr><th scope=\"row\">" + name + "</th><td class=\"number\">" +
         shown_number(scale * recorded, decimals) + " " + unit + "</td><td class=\"number\">" +
         shown_number(scale * campaign, decimals) + " " + unit + "</td></tr>\n";
}

/// The first wheel run stands for the campaign's apparatus.
const Case* campaign_case(const ReportData& data) {
  for (const RunData& run : data.runs)
    if (!run.is_bed && run.has_case) return &run.input;
  return nullptr;
}

std::string recording_card(const ReportData& data, const Recording& recording) {
  std::string body = "<h3>" + escape_html(recording.title) + "</h3>\n<p>" +
                     escape_html(recording.citation) + "</p>\n";
  if (const Case* input = campaign_case(data)) {
    const WheelCase& wheel = input->wheel;
    body +=
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Apparatus\"><table>"
        "<thead><tr><th></th><th class=\"number\">recorded</th><th class=\"number\">campaign</th>"
        "</tr></thead><tbody>\n" +
        apparatus_row("Wheel diameter", recording.wheel_diameter, wheel.diameter, 100, 2, "cm") +
        apparatus_row("Wheel width", recording.wheel_width, wheel.width, 100, 2, "cm") +
        apparatus_row("Load", recording.load, wheel.load, 1, 1, "N") +
        apparatus_row("Forward speed", recording.forward_speed, wheel.forward_speed, 1, 3, "m/s") +
        "</tbody></table></div>\n";
  }
  body += "<p>" + escape_html(recording.soil) + "</p>\n";
  if (!recording.caveats.empty()) {
    body += "<ul>\n";
    for (const std::string& caveat : recording.caveats)
      body += "<li>" + escape_html(caveat) + "</li>\n";
    body += "</ul>\n";
  }
  std::string small = recording.provenance + " Licence: " + recording.licence + ".";
  return "<article class=\"card\">\n" + body + "<p class=\"note\">" + escape_html(small) +
         "</p></article>\n";
}

}  // namespace

std::string section(const std::string& id, const std::string& heading, const std::string& body) {
  return "<section id=\"" + id + "\">\n<h2>" + heading + "</h2>\n" + body + "</section>\n";
}

std::string state_badge(const std::string& state) {
  static const std::map<std::string, const char*> kKinds{
      {"COMPLETED", "good"}, {"STEADY", "good"},   {"CHUNK_DONE", "good"},
      {"RUNNING", "busy"},   {"QUEUED", "busy"},   {"FAILED", "off"},
      {"HELD", "off"},       {"CANCELLED", "off"}, {"UNKNOWN", "off"}};
  const auto kind = kKinds.find(state);
  return std::string("<span class=\"badge ") + (kind == kKinds.end() ? "plain" : kind->second) +
         "\">" + escape_html(state) + "</span>";
}

std::string neglected_section(const ReportData& data) {
  if (data.settings.neglected.empty()) return "";
  std::string items;
  for (const std::string& text : data.settings.neglected)
    items += "<li>" + escape_html(text) + "</li>\n";
  return section("neglected", "What is neglected", "<ul class=\"plain\">\n" + items + "</ul>\n");
}

std::string recordings_section(const ReportData& data) {
  if (data.recordings.empty()) return "";
  std::string cards;
  for (const Recording& recording : data.recordings) cards += recording_card(data, recording);
  return section("recordings", "Recordings", cards);
}

std::string parameters_section(const ReportData& data) {
  HtmlTable varied("Values that differ between runs");
  HtmlTable common("Values of all runs, SI units");
  for (HtmlTable* table : {&varied, &common})
    table->header({"Key", table == &varied ? "Values" : "Value", "Unit", "Meaning"},
                  {false, table == &common, false, false});
  for (const Column& column : columns_of(data)) {
    const bool is_common = column.values.size() == 1;
    (is_common ? common : varied)
        .row({"<code>" + escape_html(column.first.key) + "</code>",
              escape_html(joined(column.values)), escape_html(column.first.unit),
              escape_html(column.first.meaning)});
  }
  if (common.rows() == 0) return "";
  return section("parameters", "Parameters",
                 (varied.rows() > 0 ? varied.html() : "") +
                     folded("All " + std::to_string(common.rows()) + " values common to the runs",
                            common.html()));
}

std::string ledger_section(const ReportData& data) {
  HtmlTable table("Every attempt of every chunk");
  table.header({"Run", "Chunk", "Attempt", "State", "Outcome", "Ranks", "Wall&#160;[s]",
                "Compute&#160;[s]", "Checkpoint&#160;[s]", "Steps",
                "Speed [10⁶&#160;particle-steps/s]", "Continued from", "Ended at"},
               {false, true, true, false, false, true, true, true, true, true, true, false, false});
  double wall = 0.0;
  double checkpoint = 0.0;
  double useful = 0.0;
  double lost = 0.0;
  for (const RunData& run : data.runs)
    for (const AttemptData& attempt : run.attempts) {
      wall += attempt.wall_seconds;
      checkpoint += attempt.checkpoint_seconds;
      useful += attempt.useful_seconds;
      lost += attempt.lost_seconds;
      table.row({escape_html(run.label), std::to_string(attempt.chunk),
                 std::to_string(attempt.number), state_badge(attempt.state),
                 escape_html(attempt.outcome),
                 attempt.ranks > 0 ? std::to_string(attempt.ranks) : "–",
                 seconds_cell(attempt.wall_seconds), seconds_cell(attempt.compute_seconds),
                 seconds_cell(attempt.checkpoint_seconds),
                 attempt.steps_done > 0 ? shown_count(attempt.steps_done) : "–", speed_of(attempt),
                 hash_cell(attempt.restart_hash), hash_cell(attempt.state_hash)});
    }
  if (table.rows() == 0) return "";
  const std::string sum =
      "<p>" + shown_count(static_cast<long long>(table.rows())) + " attempts, " +
      shown_duration(wall) + " in all: " + shown_duration(useful) + " computing that is in the " +
      "results" +
      (wall > 0.0 ? " (goodput " + shown_number(100.0 * useful / wall, 0) + "&#160;%)" : "") +
      ", " + shown_duration(lost) + " computing that was lost, " + shown_duration(checkpoint) +
      " writing checkpoints, " + shown_duration(std::max(0.0, wall - useful - lost - checkpoint)) +
      " starting and ending. Equal hashes at a seam mean that a chunk continued "
      "from exactly the state its predecessor left.</p>\n";
  return section("ledger", "Chunk ledger", sum + folded("All attempts", table.html()));
}

std::string provenance_section(const ReportData& data) {
  std::string rows;
  for (const auto& [name, value] : data.provenance)
    rows += "<tr><th scope=\"row\">" + escape_html(name) + "</th><td>" + escape_html(value) +
            "</td></tr>\n";
  HtmlTable runs("Runs");
  runs.header({"Run", "State", "Seed", "Grains", "Key of the case", "Hash of the last state"},
              {false, false, true, true, false, false});
  for (const RunData& run : data.runs)
    runs.row({escape_html(run.label), state_badge(run.state), std::to_string(run.input.grains.seed),
              run.particles > 0 ? shown_count(run.particles) : "–", hash_cell(run.key),
              hash_cell(run.state_hash)});
  return section("provenance", "Provenance",
                 "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Provenance\">"
                 "<table><tbody>\n" +
                     rows + "</tbody></table></div>\n" +
                     folded("Runs, keys and hashes", runs.html()));
}

}  // namespace grouser
