// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "campaign/report/analysis.hpp"
#include "campaign/report/report_data.hpp"

namespace grouser {

/// The whole report as one HTML file: no script, nothing loaded from elsewhere. All text that comes
/// from users is escaped. Local.
std::string report_html(const ReportData& data, const Analysis& analysis);

}  // namespace grouser
