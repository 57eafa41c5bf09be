// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/errors.hpp"

namespace grouser {

/// One measured series of one condition, in SI units.
struct RecordedCurve {
  std::string condition;
  std::string channel;        ///< "gap", "settling_speed" or "vertical_velocity"
  bool is_held_out = false;   ///< never fitted
  double noise = 0.0;         ///< one standard deviation, 0 = not stated
  std::vector<double> time;   ///< [s]
  std::vector<double> value;  ///< [m] or [m s-1]
};

/// What a report draws of a recording of series (docs/reference/formats/recording.md, version 2).
struct RecordedSeries {
  std::string name;
  std::string title;
  std::string citation;
  std::string licence;
  std::vector<RecordedCurve> curves;
};

/// Whether a folder's recording.yaml is of version 2. Local.
bool has_recorded_series(const std::filesystem::path& folder);

/// Reads it; what a report has no use for is passed over, `grouser recording validate` looks at all
/// of it. Problems are appended. Local.
RecordedSeries read_recorded_series(const std::filesystem::path& folder,
                                    std::vector<Problem>& problems);

}  // namespace grouser
