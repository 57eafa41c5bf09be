// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/settings.hpp"

#include "base/substitution.hpp"

namespace grouser {
namespace {

// Where the i-th recording is named, or the nearest place above it.
const YamlNode& path_node(const YamlNode& report, std::size_t i) {
  const YamlNode* list = report.find("recordings");
  if (list == nullptr || i >= list->items.size()) return report;
  const YamlNode* path = list->items[i].find("path");
  return path == nullptr ? list->items[i] : *path;
}

}  // namespace

SlipDefinition ReportSettings::slip_definition() const {
  return find_slip_definition(horizontal).value_or(SlipDefinition::kPowered);
}

void describe(FieldVisitor& v, ReportSettings& s) {
  v.word({"horizontal",
          "slip of the curves' axis: powered is 1 - v/(omega r), bounded (omega r - v)/max(omega "
          "r, v)",
          kOptional},
         s.horizontal, {"powered", "bounded"});
  v.word({"scatter_axis",
          "sweep axis that repeats a point: runs that differ only on it are one point with scatter",
          kOptional},
         s.scatter_axis, {});
  v.list(
      {"recordings",
       "measured values, set beside the campaign in curves and in a table of differences",
       kOptional},
      s.recordings.size(), [&](std::size_t count) { s.recordings.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) {
        inner.word(
            {"path", "folder of a recording.yaml; relative paths count from the campaign file"},
            s.recordings[i], {});
        inner.check("path", names_in_braces(s.recordings[i]).empty(), "takes no {name}",
                    "write the path itself");
      });
  v.list(
      {"neglected", "what the campaign leaves out; a list in the report", kOptional},
      s.neglected.size(), [&](std::size_t count) { s.neglected.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) {
        inner.word({"text", "one simplification and its reason, in plain text"}, s.neglected[i],
                   {});
      });
}

std::string report_reference() {
  ReportSettings settings;
  return "## Report\n\n| key | unit | range | default | meaning |\n|---|---|---|---|---|\n" +
         reference_of([&](FieldVisitor& v) { describe(v, settings); }, "report");
}

ReportSettings read_report_settings(const YamlNode& node, std::vector<Problem>& problems) {
  ReportSettings settings;
  if (node.kind == YamlNode::Kind::kNull) return settings;
  read_fields(
      node, [&](FieldVisitor& visitor) { describe(visitor, settings); }, problems, "report");
  return settings;
}

std::vector<Recording> read_recordings(const YamlNode& node, const ReportSettings& settings,
                                       const std::filesystem::path& directory,
                                       std::vector<Problem>& problems) {
  std::vector<Recording> recordings;
  for (std::size_t i = 0; i < settings.recordings.size(); ++i) {
    if (settings.recordings[i].empty()) continue;  // a mistake that is named already
    const std::filesystem::path folder = directory / settings.recordings[i];
    std::error_code unreadable;
    if (std::filesystem::is_regular_file(folder / "recording.yaml", unreadable)) {
      if (!has_recorded_series(folder)) recordings.push_back(read_recording(folder, problems));
      continue;
    }
    const YamlNode& at = path_node(node, i);
    problems.push_back(
        {at.file, at.line, at.column, "report.recordings[" + std::to_string(i) + "].path",
         (folder / "recording.yaml").lexically_normal().string() + ": cannot be read",
         "paths count from " + directory.string()});
  }
  return recordings;
}

std::vector<RecordedSeries> read_recorded_series(const ReportSettings& settings,
                                                 const std::filesystem::path& directory,
                                                 std::vector<Problem>& problems) {
  std::vector<RecordedSeries> recordings;
  for (const std::string& path : settings.recordings)
    if (!path.empty() && has_recorded_series(directory / path))
      recordings.push_back(read_recorded_series(directory / path, problems));
  return recordings;
}

}  // namespace grouser
