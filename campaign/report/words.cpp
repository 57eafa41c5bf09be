// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/words.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <vector>

#include "campaign/report/html.hpp"

namespace grouser {
namespace {

constexpr std::size_t kMostNamed = 4;
constexpr const char* kNoBreak = "\u00A0";

const RecordingPoint& recorded(const ReportData& data, const Comparison& c) {
  return data.recordings[c.recording].points[c.point];
}

std::string in_lower_case(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

/// "pull coefficient at 20 % slip", "drawbar pull, towed"
std::string name_of(const ReportData& data, const Comparison& c) {
  const RecordingPoint& point = recorded(data, c);
  const std::string heading = in_lower_case(entry_of(point.observable).heading);
  if (point.is_towed()) return heading + ", towed";
  if (!std::isfinite(c.slip)) return heading + " at " + point.condition;
  return heading + " at " + shown_number(100.0 * c.slip, 0) + kNoBreak + "% slip";
}

std::string value_in_words(Observable observable, double value) {
  const ObservableEntry& entry = entry_of(observable);
  return shown_number(entry.shown_scale * value, entry.shown_decimals) + kNoBreak +
         entry.shown_unit;
}

std::string inside_sentence(const ReportData& data, const std::vector<const Comparison*>& known,
                            const std::string& whose) {
  std::vector<std::string> inside;
  for (const Comparison* c : known)
    if (c->is_inside()) inside.push_back(name_of(data, *c));
  std::string text = std::to_string(inside.size()) + " of " + std::to_string(known.size()) + " " +
                     whose + (known.size() == 1 ? " value" : " values") + " " +
                     (inside.size() == 1 ? "lies" : "lie") + " inside the seed scatter";
  if (inside.empty() || inside.size() > kMostNamed) return text + ".";
  text += ": ";
  for (std::size_t i = 0; i < inside.size(); ++i) text += (i == 0 ? "" : "; ") + inside[i];
  return text + ".";
}

/// The largest difference of every observable, one clause each.
std::string largest_sentence(const ReportData& data, const std::vector<const Comparison*>& known) {
  std::map<Observable, const Comparison*> largest;
  for (const Comparison* c : known) {
    const Comparison*& at = largest[recorded(data, *c).observable];
    if (at == nullptr || std::abs(c->difference) > std::abs(at->difference)) at = c;
  }
  std::string text;
  for (const auto& [observable, c] : largest) {
    const ObservableEntry& entry = entry_of(observable);
    const std::string sign = c->difference > 0.0 ? "+" : "";
    text += (text.empty() ? "Largest difference: " : "; ") + name_of(data, *c) + ", " +
            value_in_words(observable, c->campaign) + " here against " +
            value_in_words(observable, recorded(data, *c).value) + " (" + sign +
            shown_number(entry.shown_scale * c->difference, entry.shown_decimals) + " " +
            entry.difference_unit + ")";
  }
  return text.empty() ? text : text + ".";
}

}  // namespace

std::string result_in_words(const ReportData& data, const Analysis& analysis,
                            const std::string& kind) {
  const std::string whose = kind == "lab" ? "laboratory" : "published-simulation";
  std::vector<const Comparison*> known;
  std::size_t waiting = 0;
  for (const Comparison& c : analysis.comparisons) {
    if (recorded(data, c).kind != kind) continue;
    if (c.is_known())
      known.push_back(&c);
    else
      ++waiting;
  }
  std::string text;
  if (!known.empty())
    text = inside_sentence(data, known, whose) + " " + largest_sentence(data, known);
  if (waiting > 0)
    text += (text.empty() ? "" : " ") + std::to_string(waiting) + " " + whose +
            (waiting == 1 ? " value has" : " values have") + " no counterpart in the campaign" +
            (std::all_of(data.runs.begin(), data.runs.end(),
                         [](const RunData& run) { return run.is_finished; })
                 ? "."
                 : " yet.");
  return text;
}

std::string progress_in_words(const ReportData& data) {
  std::size_t runs = 0;
  std::size_t finished = 0;
  std::map<std::string, std::size_t> others;
  for (const RunData& run : data.runs) {
    if (run.is_bed) continue;
    ++runs;
    if (run.is_finished)
      ++finished;
    else
      ++others[run.state];
  }
  if (runs == 0) return "The campaign has no wheel runs.";
  if (finished == runs)
    return runs == 1 ? "The run is finished."
                     : "All " + std::to_string(runs) + " runs are finished.";
  std::string text =
      std::to_string(finished) + " of " + std::to_string(runs) + " runs are finished";
  const char* separator = " (others: ";
  for (const auto& [state, count] : others) {
    text += separator + std::to_string(count) + " " + state;
    separator = ", ";
  }
  return text + ").";
}

std::string drift_in_words(const Analysis& analysis) {
  std::string text;
  for (const Observable observable :
       {Observable::kPullCoefficient, Observable::kGrossCoefficient, Observable::kSinkage}) {
    const auto drifting =
        std::count_if(analysis.runs.begin(), analysis.runs.end(), [&](const RunResult& result) {
          return result.window.is_complete && result.of(observable).is_drifting();
        });
    if (drifting == 0) continue;
    text += (text.empty() ? "Not steady within the averaging window: " : ", ") +
            in_lower_case(entry_of(observable).heading) + " in " + std::to_string(drifting) +
            (drifting == 1 ? " run" : " runs");
  }
  return text.empty() ? text : text + ". Means then depend on where the window is.";
}

}  // namespace grouser
