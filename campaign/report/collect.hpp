// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "campaign/report/report_data.hpp"

namespace grouser {

/// Gathers what a report needs from the database, the run directories, the frozen campaign file and
/// its recordings, for the runs in the plan. Files that are missing or damaged become warnings.
/// Local.
/// @param now seconds since 1970, the report's date
/// @throws StorageError, FormatError when the database cannot be read
ReportData collect_report(const std::filesystem::path& campaign_root, double now);

/// "2026-03-01 14:05 UTC" of seconds since 1970. Local.
std::string date_of(double seconds);

}  // namespace grouser
