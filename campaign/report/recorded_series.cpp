// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/recorded_series.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "base/atomic_file.hpp"
#include "base/schema.hpp"
#include "base/units.hpp"
#include "campaign/report/csv.hpp"

namespace grouser {
namespace {

struct Channel {
  std::string name;
  std::string unit = "1";
  std::string column;
  std::string noise = "estimate";
};

struct Condition {
  std::string name;
  std::string file;
  std::string split = "fit";
};

struct Frame {
  RecordedSeries series;
  std::string time_column;
  std::string time_unit = "s";
  std::vector<Channel> channels;
  std::vector<Condition> conditions;
};

const char* si_unit(const Channel& channel) { return channel.name == "gap" ? "m" : "m s-1"; }

double factor(const std::string& unit, const char* si) {
  try {
    return parse_quantity("1 " + unit, si);
  } catch (const std::invalid_argument&) {
    return NAN;
  }
}

void describe_channel(FieldVisitor& v, Channel& c) {
  std::string sign;
  v.word({"name", "observable"}, c.name, {"gap", "settling_speed", "vertical_velocity"});
  v.word({"unit", "of the column"}, c.unit, {});
  v.word({"column", "header in the CSV"}, c.column, {});
  v.word({"sign", "what positive means", kOptional}, sign, {});
  v.word({"noise", "one standard deviation, or estimate", kOptional}, c.noise, {});
  v.check("unit", std::isfinite(factor(c.unit, si_unit(c))),
          "'" + c.unit + "' cannot be turned into " + si_unit(c), "");
}

void describe_condition(FieldVisitor& v, Condition& c) {
  YamlNode rest;
  v.word({"name", "of the run"}, c.name, {});
  v.word({"data", "CSV in the same folder"}, c.file, {});
  v.word({"split", "fit or held_out", kOptional}, c.split, {"fit", "held_out"});
  v.raw({"values", "settings", kOptional}, rest);
}

void describe_frame(FieldVisitor& v, Frame& f) {
  std::int64_t version = 2;
  std::string provenance;
  YamlNode rest;
  v.integer({"recording", "version of the format"}, version, 2, 2);
  v.word({"name", "short name"}, f.series.name, {});
  v.word({"title", "one line"}, f.series.title, {});
  v.group({"source", "where the values come from"}, [&](FieldVisitor& inner) {
    inner.word({"citation", "who published it"}, f.series.citation, {});
    inner.word({"licence", "terms"}, f.series.licence, {});
    inner.word({"provenance", "how it was read"}, provenance, {});
  });
  v.raw({"experiment", "what was done", kOptional}, rest);
  v.group({"time", "time column"}, [&](FieldVisitor& inner) {
    inner.word({"column", "header in the CSV"}, f.time_column, {});
    inner.word({"unit", "of the time"}, f.time_unit, {});
  });
  v.list(
      {"channels", "what was measured"}, f.channels.size(),
      [&](std::size_t count) { f.channels.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_channel(inner, f.channels[i]); });
  v.list(
      {"conditions", "runs of the experiment"}, f.conditions.size(),
      [&](std::size_t count) { f.conditions.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_condition(inner, f.conditions[i]); });
  v.raw({"caveats", "what a reader must know", kOptional}, rest);
}

// Column whose header is `name`, with or without a unit in brackets.
std::optional<std::size_t> column_named(const CsvTable& table, const std::string& name) {
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    const std::string& header = table.header[i];
    if (header == name || header.substr(0, header.find(" [")) == name) return i;
  }
  return std::nullopt;
}

double noise_of(const Channel& channel) {
  try {
    return channel.noise == "estimate" ? 0.0 : parse_quantity(channel.noise, si_unit(channel));
  } catch (const std::invalid_argument&) {
    return 0.0;  // validate says so
  }
}

void read_curves(const std::filesystem::path& folder, const Condition& condition, Frame& frame,
                 std::vector<Problem>& problems) {
  const std::filesystem::path file = folder / condition.file;
  const auto text = read_file(file);
  if (!text) {
    problems.push_back({file.string(), 0, 0, "conditions.data", "no such file", ""});
    return;
  }
  const CsvTable table = parse_csv(*text);
  const auto time = column_named(table, frame.time_column);
  for (const Channel& channel : frame.channels) {
    const auto column = column_named(table, channel.column);
    if (!time || !column) {
      problems.push_back({file.string(), 1, 0, time ? channel.column : frame.time_column,
                          "column is missing", ""});
      return;
    }
    RecordedCurve curve{condition.name,    channel.name, condition.split == "held_out",
                        noise_of(channel), {},           {}};
    for (const auto& row : table.rows) {
      if (row.size() != table.header.size() || row[*column].empty()) continue;
      curve.time.push_back(factor(frame.time_unit, "s") * number_of(row[*time]));
      curve.value.push_back(factor(channel.unit, si_unit(channel)) * number_of(row[*column]));
    }
    frame.series.curves.push_back(std::move(curve));
  }
}

}  // namespace

bool has_recorded_series(const std::filesystem::path& folder) {
  try {
    const YamlNode file = load_yaml(folder / "recording.yaml");
    const YamlNode* version = file.find("recording");
    return version != nullptr && version->scalar == "2";
  } catch (const ConfigError&) {
    return false;
  }
}

RecordedSeries read_recorded_series(const std::filesystem::path& folder,
                                    std::vector<Problem>& problems) {
  Frame frame;
  const std::size_t before = problems.size();
  const YamlNode file = load_yaml(folder / "recording.yaml");
  read_fields(
      file, [&](FieldVisitor& visitor) { describe_frame(visitor, frame); }, problems);
  if (problems.size() == before)
    for (const Condition& condition : frame.conditions)
      read_curves(folder, condition, frame, problems);
  return std::move(frame.series);
}

}  // namespace grouser
