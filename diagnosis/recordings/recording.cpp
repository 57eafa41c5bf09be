// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/recordings/recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "base/units.hpp"
#include "diagnosis/recordings/series_csv.hpp"

namespace grouser::diagnosis {
namespace {

/// A number with its unit, or what is wrong with it.
struct Parsed {
  double value = 0.0;
  std::string problem;
};

Parsed parse(const std::string& text, const std::string& unit) {
  try {
    return {parse_quantity(text, unit), ""};
  } catch (const std::invalid_argument& error) {
    return {0.0, error.what()};
  }
}

std::vector<std::string> experiment_values() {
  std::vector<std::string> names;
  for (const SettingEntry& entry : kSettings)
    if (entry.kind == SettingKind::kExperiment) names.emplace_back(entry.name);
  return names;
}

std::vector<std::string> signal_names() {
  std::vector<std::string> names;
  for (const SignalEntry& entry : kSignals) names.emplace_back(entry.name);
  return names;
}

void describe_value(FieldVisitor& v, KnownValue& known) {
  v.word({"name", "setting of the experiment"}, known.name, experiment_values());
  v.word({"value", "with its unit"}, known.value_text, {});
  v.word({"uncertainty", "one standard deviation with its unit; 0 = exact", kOptional},
         known.uncertainty_text, {});
  const std::optional<Setting> setting = find_setting(known.name);
  if (!setting) return;
  known.setting = *setting;
  const char* const unit = entry_of(*setting).unit;
  const Parsed value = parse(known.value_text, unit);
  const Parsed sd = known.uncertainty_text == "0" ? Parsed{} : parse(known.uncertainty_text, unit);
  known.value = value.value;
  known.uncertainty = sd.value;
  v.check("value", value.problem.empty(), value.problem, std::string("unit as in 1 ") + unit);
  v.check("uncertainty", sd.problem.empty() && sd.value >= 0.0,
          sd.problem.empty() ? "is negative" : sd.problem, "one standard deviation");
  const bool needs_positive = *setting == Setting::kDiameter || *setting == Setting::kViscosity ||
                              *setting == Setting::kParticleDensity;
  v.check("value", !needs_positive || !value.problem.empty() || value.value > 0.0,
          "'" + known.value_text + "' is not above 0", "");
}

void describe_values(FieldVisitor& v, std::vector<KnownValue>& values, Field::Need need) {
  v.list(
      {"values", "settings that are known, with uncertainties", need}, values.size(),
      [&](std::size_t count) { values.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_value(inner, values[i]); });
}

void describe_channel(FieldVisitor& v, SignalChannel& channel) {
  v.word({"name", "observable of the vocabulary"}, channel.name, signal_names());
  v.word({"unit", "of the column's numbers"}, channel.unit, {});
  v.word({"column", "header in the CSV files"}, channel.column, {});
  v.word({"sign", "what positive means"}, channel.sign, {});
  v.word({"noise", "one standard deviation with its unit, or `estimate`", kOptional}, channel.noise,
         {});
  const std::optional<Signal> signal = find_signal(channel.name);
  if (!signal) return;
  channel.signal = *signal;
  const char* const unit = entry_of(*signal).unit;
  const Parsed factor = parse("1 " + channel.unit, unit);
  channel.to_si = factor.value;
  v.check("unit", factor.problem.empty(), factor.problem,
          std::string("the observable is held in ") + unit);
  if (channel.noise == "estimate") return;
  const Parsed noise = parse(channel.noise, unit);
  channel.noise_sd = noise.value;
  v.check("noise", noise.problem.empty() && noise.value > 0.0,
          noise.problem.empty() ? "is not above 0" : noise.problem,
          "a quantity, or `estimate` when it is not known");
}

void describe_condition(FieldVisitor& v, Condition& condition) {
  v.word({"name", "of the run"}, condition.name, {});
  v.word({"data", "CSV file in the same folder"}, condition.file, {});
  v.word({"split", "whether it may be fitted", kOptional}, condition.split, {"fit", "held_out"});
  describe_values(v, condition.values, kOptional);
}

void describe_time(FieldVisitor& v, SeriesRecording& r) {
  v.word({"column", "header in the CSV files"}, r.time_column, {});
  v.word({"unit", "of that column"}, r.time_unit, {});
  const Parsed factor = parse("1 " + r.time_unit, "s");
  v.check("unit", factor.problem.empty(), factor.problem, "a unit of time");
}

bool is_unique(const std::vector<KnownValue>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (values[i].name == values[j].name) return false;
  return true;
}

bool has_value(const SeriesRecording& r, const Condition& c, const char* name) {
  const auto is_it = [&](const KnownValue& known) { return known.name == name; };
  return std::any_of(r.values.begin(), r.values.end(), is_it) ||
         std::any_of(c.values.begin(), c.values.end(), is_it);
}

/// Rules over the whole recording: what is said twice, and what a sphere cannot do without.
void describe_rules(FieldVisitor& v, const SeriesRecording& r) {
  static constexpr std::array kNeeded{"diameter", "particle_density", "fluid_density", "viscosity"};
  bool is_fitted = false;
  for (std::size_t i = 0; i < r.conditions.size(); ++i) {
    const Condition& condition = r.conditions[i];
    is_fitted = is_fitted || !condition.is_held_out();
    for (std::size_t j = 0; j < i; ++j)
      v.rule("conditions", condition.name != r.conditions[j].name,
             "two conditions are called '" + condition.name + "'", "each has its own name");
    v.rule("conditions", is_unique(condition.values),
           "condition '" + condition.name + "' gives a value twice", "keep one of them");
    for (const char* const name : kNeeded)
      v.rule("conditions", has_value(r, condition, name),
             "condition '" + condition.name + "' has no " + name,
             "give it there or in experiment.values");
  }
  v.rule("conditions", is_fitted, "no condition may be fitted", "one needs `split: fit`");
  v.rule("experiment", is_unique(r.values), "a value is given twice", "keep one of them");
  v.rule("channels", !r.channels.empty(), "there is no channel", "name what was measured");
}

}  // namespace

void describe(FieldVisitor& v, SeriesRecording& r) {
  v.integer({"recording", "version of the recording format"}, r.version, 2, 2);
  v.word({"name", "short name, as the folder's"}, r.name, {});
  v.word({"title", "one line for headings"}, r.title, {});
  v.group({"source", "where the values come from"}, [&](FieldVisitor& inner) {
    inner.word({"citation", "who published it, where"}, r.citation, {});
    inner.word({"licence", "terms under which the values are kept here"}, r.licence, {});
    inner.word({"provenance", "how the values got from the source into the CSV"}, r.provenance, {});
  });
  v.group({"experiment", "what was done"}, [&](FieldVisitor& inner) {
    inner.word({"case", "which kind of experiment"}, r.experiment, {"sphere_in_fluid"});
    describe_values(inner, r.values, kOptional);
  });
  v.group({"time", "the clock of all series"},
          [&](FieldVisitor& inner) { describe_time(inner, r); });
  v.list(
      {"channels", "what was measured over time"}, r.channels.size(),
      [&](std::size_t count) { r.channels.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_channel(inner, r.channels[i]); });
  v.list(
      {"conditions", "runs of the experiment, one series each"}, r.conditions.size(),
      [&](std::size_t count) { r.conditions.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_condition(inner, r.conditions[i]); });
  v.list(
      {"caveats", "what a reader must know before believing the numbers", kOptional},
      r.caveats.size(), [&](std::size_t count) { r.caveats.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) {
        inner.word({"text", "one caveat"}, r.caveats[i], {});
      });
  describe_rules(v, r);
}

SeriesRecording read_series_recording(const std::filesystem::path& path,
                                      std::vector<Problem>& problems) {
  const std::filesystem::path file =
      std::filesystem::is_directory(path) ? path / "recording.yaml" : path;
  SeriesRecording recording;
  const std::size_t before = problems.size();
  try {
    const YamlNode node = load_yaml(file);
    read_fields(
        node, [&](FieldVisitor& visitor) { describe(visitor, recording); }, problems);
  } catch (const ConfigError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
  // Series are read with the channels' units, which must be sound first.
  if (problems.size() != before) return recording;
  for (Condition& condition : recording.conditions)
    read_series(file.parent_path() / condition.file, recording, condition, problems);
  return recording;
}

bool is_series_recording(const std::filesystem::path& folder) {
  try {
    const YamlNode node = load_yaml(folder / "recording.yaml");
    const YamlNode* const version = node.find("recording");
    return version != nullptr && version->scalar == "2";
  } catch (const ConfigError&) {
    return false;
  }
}

}  // namespace grouser::diagnosis
