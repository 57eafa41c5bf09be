// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "campaign/report/analysis.hpp"
#include "campaign/report/report_data.hpp"

namespace grouser {

/// The report's CSV files and the terminal's table. Formats: docs/reference/formats/report_csv.md.
/// All values SI, NaN as an empty cell. Local.

/// One row per wheel run.
std::string results_csv(const ReportData& data, const Analysis& analysis);

/// One row per point of the sweep, seeds together.
std::string means_csv(const Analysis& analysis);

/// One row per recorded value.
std::string compare_csv(const ReportData& data, const Analysis& analysis);

/// The points and, beside them, the recorded values, as text of at most about 100 columns.
std::string summary_text(const ReportData& data, const Analysis& analysis);

}  // namespace grouser
