// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/schema.hpp"
#include "campaign/report/observables.hpp"
#include "campaign/report/recorded_series.hpp"
#include "campaign/report/recording.hpp"

namespace grouser {

/// The `report:` part of a campaign.
struct ReportSettings {
  std::string horizontal = "powered";   ///< word of a SlipDefinition
  std::string scatter_axis = "seed";    ///< sweep axis that repeats a point instead of making one
  std::vector<std::string> recordings;  ///< folders, relative to the campaign file
  std::vector<std::string> neglected;   ///< what the campaign leaves out, for readers

  SlipDefinition slip_definition() const;
};

/// The one description of `report:`; see FieldVisitor.
void describe(FieldVisitor& visitor, ReportSettings& settings);

/// The reference page's table of all keys of `report:`, in Markdown. Local.
std::string report_reference();

/// Reads and checks `report:`; a null node gives the defaults. Problems are appended. Local.
ReportSettings read_report_settings(const YamlNode& node, std::vector<Problem>& problems);

/// Reads the recordings of single values that `report:` names. One that is not there is a problem
/// at the place of its name in `node`. @param directory from which relative paths count. Problems
/// are appended. Local.
std::vector<Recording> read_recordings(const YamlNode& node, const ReportSettings& settings,
                                       const std::filesystem::path& directory,
                                       std::vector<Problem>& problems);

/// Those of them that hold series over time. Problems are appended. Local.
std::vector<RecordedSeries> read_recorded_series(const ReportSettings& settings,
                                                 const std::filesystem::path& directory,
                                                 std::vector<Problem>& problems);

}  // namespace grouser
