// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/schema.hpp"
#include "campaign/report/observables.hpp"

namespace grouser {

/// One observable of a recording and how its numbers are written.
struct RecordingChannel {
  std::string name;  ///< of an Observable
  std::string unit = "1";
  std::string sign;
};

/// One measured or published value, in SI units.
struct RecordingPoint {
  std::string condition;  ///< "towed" is the freely rotating wheel
  double slip = kNaN;     ///< after the recording's definition; NaN = not known [1]
  std::string kind;       ///< "lab" or "paper_dem"
  Observable observable = Observable::kPullCoefficient;
  double value = kNaN;        ///< [unit of the observable]
  double uncertainty = kNaN;  ///< one standard deviation; NaN = unknown
  double trials = kNaN;       ///< NaN = unknown

  bool is_towed() const { return condition == "towed"; }
};

/// Measured values with their provenance. Format: docs/reference/formats/recording.md.
struct Recording {
  std::int64_t version = 1;
  std::string name;
  std::string title;
  std::string citation;
  std::string licence;
  std::string provenance;
  double wheel_diameter = 0.0;  ///< [m]
  double wheel_width = 0.0;     ///< [m]
  double load = 0.0;            ///< [N]
  double forward_speed = 0.0;   ///< [m s-1]
  std::string soil;
  std::string slip_definition = "powered";
  std::vector<RecordingChannel> channels;
  std::string points_file;
  std::vector<std::string> caveats;
  std::vector<RecordingPoint> points;  ///< from the CSV, not from the YAML

  SlipDefinition definition() const;
};

/// The one description of recording.yaml; see FieldVisitor.
void describe(FieldVisitor& visitor, Recording& recording);

/// Reads `folder`/recording.yaml and its points. Everything wrong is appended to `problems`, a
/// missing file as well; what could be read is returned. Local.
Recording read_recording(const std::filesystem::path& folder, std::vector<Problem>& problems);

}  // namespace grouser
