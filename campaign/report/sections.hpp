// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "campaign/report/analysis.hpp"
#include "campaign/report/report_data.hpp"

namespace grouser {

/// Parts of the report below its heading, each a `<section>` in HTML, or "" when there is nothing
/// to show. Local.

std::string curves_section(const ReportData& data, const Analysis& analysis);
std::string comparison_section(const ReportData& data, const Analysis& analysis);
std::string points_section(const ReportData& data, const Analysis& analysis);
std::string pictures_section(const ReportData& data, const Analysis& analysis);
std::string runs_section(const ReportData& data, const Analysis& analysis);

std::string tracks_section(const ReportData& data);

std::string neglected_section(const ReportData& data);
std::string recordings_section(const ReportData& data);
std::string parameters_section(const ReportData& data);
std::string ledger_section(const ReportData& data);
std::string provenance_section(const ReportData& data);

/// A section with its heading and an anchor. @param id for links within the page
std::string section(const std::string& id, const std::string& heading, const std::string& body);

/// The word of a state with a colour of its own kind.
std::string state_badge(const std::string& state);

}  // namespace grouser
