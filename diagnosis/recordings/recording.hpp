// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/schema.hpp"
#include "diagnosis/recordings/settings.hpp"

namespace grouser::diagnosis {

/// What is known of one setting of the experiment: a value and one standard deviation, in SI.
struct KnownValue {
  std::string name;
  std::string value_text;
  std::string uncertainty_text = "0";
  Setting setting = Setting::kDiameter;
  double value = 0.0;
  double uncertainty = 0.0;  ///< 0 = exact
};

/// One measured series of every condition and how its numbers are written.
struct SignalChannel {
  std::string name;
  std::string unit = "1";
  std::string column;              ///< header in the CSV files
  std::string sign;                ///< what positive means, in words
  std::string noise = "estimate";  /// text of a quantity, or `estimate`
  Signal signal = Signal::kGap;
  double noise_sd = 0.0;  ///< [SI unit of the signal]; 0 = to be estimated
  double to_si = 1.0;     ///< factor on the CSV's numbers
};

/// One run of the experiment: its own settings and its series.
struct Condition {
  std::string name;
  std::string file;
  std::string split = "fit";  ///< `fit` or `held_out`
  std::vector<KnownValue> values;
  std::vector<double> times;                 ///< [s], ascending
  std::vector<std::vector<double>> samples;  ///< per channel, SI, as long as `times`
  std::vector<int> lines;                    ///< of the samples in the CSV, 1-based

  bool is_held_out() const { return split == "held_out"; }
};

/// Recorded series with their provenance. Format: docs/reference/formats/recording.md, version 2.
struct SeriesRecording {
  std::int64_t version = 2;
  std::string name;
  std::string title;
  std::string citation;
  std::string licence;
  std::string provenance;
  std::string experiment;
  std::string time_column = "time";
  std::string time_unit = "s";
  std::vector<KnownValue> values;  ///< of all conditions
  std::vector<SignalChannel> channels;
  std::vector<Condition> conditions;
  std::vector<std::string> caveats;
};

/// The one description of a recording.yaml of version 2; see FieldVisitor.
void describe(FieldVisitor& visitor, SeriesRecording& recording);

/// Reads `path` (a recording.yaml or its folder) and the series it names. Everything wrong is
/// appended to `problems`; what could be read is returned. Local.
SeriesRecording read_series_recording(const std::filesystem::path& path,
                                      std::vector<Problem>& problems);

/// Whether `folder` holds a recording of this version rather than one of single values. Local.
bool is_series_recording(const std::filesystem::path& folder);

}  // namespace grouser::diagnosis
