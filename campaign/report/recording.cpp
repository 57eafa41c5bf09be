// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/recording.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "base/atomic_file.hpp"
#include "base/units.hpp"
#include "campaign/report/csv.hpp"

namespace grouser {
namespace {

constexpr std::array<const char*, 7> kPointColumns{
    "condition", "slip", "kind", "observable", "value", "uncertainty", "trials"};

std::vector<std::string> observable_names() {
  std::vector<std::string> names;
  for (const ObservableEntry& entry : kObservables) names.emplace_back(entry.name);
  return names;
}

/// Factor from a channel's unit to the SI unit of its observable, or nothing.
std::optional<double> factor_to_si(const RecordingChannel& channel) {
  const std::optional<Observable> observable = find_observable(channel.name);
  if (!observable) return std::nullopt;
  try {
    return parse_quantity(channel.unit == "1" ? "1" : "1 " + channel.unit,
                          entry_of(*observable).unit);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// Reads the cells of one row, reporting each that cannot be used.
class PointReader {
 public:
  PointReader(const Recording& recording, const CsvTable& table, std::string file,
              std::vector<Problem>& problems)
      : recording_(recording), table_(table), file_(std::move(file)), problems_(problems) {}

  RecordingPoint read(std::size_t row) {
    row_ = row;
    RecordingPoint point;
    point.condition = cell("condition");
    if (point.condition.empty()) report("condition", "is empty", "name the condition");
    point.kind = cell("kind");
    if (point.kind != "lab" && point.kind != "paper_dem")
      report("kind", "'" + point.kind + "' is neither lab nor paper_dem", "");
    point.slip = number("slip", !point.is_towed());
    point.trials = number("trials", false);
    const double factor = read_observable(point);
    point.value = factor * number("value", true);
    point.uncertainty = factor * number("uncertainty", false);
    return point;
  }

 private:
  std::string cell(const std::string& column) const {
    return table_.rows[row_][*table_.column(column)];
  }

  double number(const std::string& column, bool needed) {
    const std::string text = cell(column);
    const double value = number_of(text);
    if (std::isnan(value) && (needed || !text.empty()))
      report(column, text.empty() ? "is empty" : "'" + text + "' is not a number", "");
    return value;
  }

  double read_observable(RecordingPoint& point) {
    const std::string name = cell("observable");
    for (const RecordingChannel& channel : recording_.channels) {
      if (channel.name != name) continue;
      point.observable = find_observable(name).value_or(Observable::kPull);
      return factor_to_si(channel).value_or(kNaN);
    }
    report("observable", "'" + name + "' is not one of the channels", "declare it in channels:");
    return kNaN;
  }

  void report(const std::string& column, const std::string& problem, const std::string& hint) {
    problems_.push_back({file_, table_.lines[row_], 0, column, problem, hint});
  }

  const Recording& recording_;
  const CsvTable& table_;
  std::string file_;
  std::vector<Problem>& problems_;
  std::size_t row_ = 0;
};

void read_points(const std::filesystem::path& file, Recording& recording,
                 std::vector<Problem>& problems) {
  const std::optional<std::string> text = read_file(file);
  if (!text) {
    problems.push_back({file.string(), 0, 0, "points", "no such file", "it is named in points:"});
    return;
  }
  const CsvTable table = parse_csv(*text);
  for (const char* const name : kPointColumns)
    if (!table.column(name)) {
      problems.push_back({file.string(), 1, 0, name, "column is missing", ""});
      return;
    }
  PointReader reader(recording, table, file.string(), problems);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (table.rows[row].size() != table.header.size()) {
      problems.push_back({file.string(), table.lines[row], 0, "row",
                          "has " + std::to_string(table.rows[row].size()) + " cells instead of " +
                              std::to_string(table.header.size()),
                          ""});
      continue;
    }
    recording.points.push_back(reader.read(row));
  }
}

void describe_channel(FieldVisitor& v, RecordingChannel& channel) {
  v.word({"name", "observable"}, channel.name, observable_names());
  v.word({"unit", "unit of value and uncertainty in the points"}, channel.unit, {});
  v.word({"sign", "what positive means"}, channel.sign, {});
  v.check("unit", factor_to_si(channel).has_value(),
          "'" + channel.unit + "' cannot be turned into the observable's unit",
          "see docs/reference/formats/recording.md");
}

}  // namespace

SlipDefinition Recording::definition() const {
  return find_slip_definition(slip_definition).value_or(SlipDefinition::kPowered);
}

void describe(FieldVisitor& v, Recording& r) {
  v.integer({"recording", "version of the recording format"}, r.version, 1, 1);
  v.word({"name", "short name, as the folder's"}, r.name, {});
  v.word({"title", "one line for headings"}, r.title, {});
  v.group({"source", "where the values come from"}, [&](FieldVisitor& inner) {
    inner.word({"citation", "who published it, where"}, r.citation, {});
    inner.word({"licence", "terms under which the values are kept here"}, r.licence, {});
    inner.word({"provenance", "how the values got from the source into the CSV"}, r.provenance, {});
  });
  v.group({"apparatus", "what was measured"}, [&](FieldVisitor& inner) {
    inner.quantity({"wheel_diameter", "wheel diameter"}, r.wheel_diameter, "m", Range::positive());
    inner.quantity({"wheel_width", "wheel width"}, r.wheel_width, "m", Range::positive());
    inner.quantity({"load", "vertical load, wheel included"}, r.load, "N", Range::positive());
    inner.quantity({"forward_speed", "speed of the axle"}, r.forward_speed, "m s-1",
                   Range::positive());
    inner.word({"soil", "what is known of the soil and its container"}, r.soil, {});
  });
  v.word({"slip_definition", "how slip is counted"}, r.slip_definition, {"powered", "bounded"});
  v.list(
      {"channels", "observables and their units and signs"}, r.channels.size(),
      [&](std::size_t count) { r.channels.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_channel(inner, r.channels[i]); });
  v.word({"points", "CSV file in the same folder"}, r.points_file, {});
  v.list(
      {"caveats", "what a reader must know before believing the numbers", kOptional},
      r.caveats.size(), [&](std::size_t count) { r.caveats.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) {
        inner.word({"text", "one caveat"}, r.caveats[i], {});
      });
}

Recording read_recording(const std::filesystem::path& folder, std::vector<Problem>& problems) {
  Recording recording;
  const std::size_t before = problems.size();
  try {
    const YamlNode node = load_yaml(folder / "recording.yaml");
    read_fields(
        node, [&](FieldVisitor& visitor) { describe(visitor, recording); }, problems);
  } catch (const ConfigError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
  // Points are read with the channels' units, which must be sound first.
  if (problems.size() == before) read_points(folder / recording.points_file, recording, problems);
  return recording;
}

}  // namespace grouser
