// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/yaml.hpp"

namespace grouser {

struct ReportRequest {
  std::filesystem::path campaign_root;  ///< holds the database and the run directories
};

/// Writes report/report.html, results.csv, means.csv and compare.csv into the campaign root, each
/// replaced at once. Works for a campaign in any state; what is missing is shown as missing.
/// Nothing but these files is written; the database is only read. Local.
/// @return the HTML file
/// @throws StorageError, FormatError when there is no readable campaign or nothing can be written
std::filesystem::path write_report(const ReportRequest& request);

/// The means and the recorded values as text for a terminal. @throws as write_report. Local.
std::string summary_table(const ReportRequest& request);

/// Checks the `report:` part of a campaign and reads the recordings it names, appending every
/// problem found. @param directory of the campaign file, from which their paths count. Local.
void check_report(const YamlNode& report, const std::filesystem::path& directory,
                  std::vector<Problem>& problems);

}  // namespace grouser
