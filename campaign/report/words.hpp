// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "campaign/report/analysis.hpp"
#include "campaign/report/report_data.hpp"

namespace grouser {

/// How far the campaign is, one sentence. Plain text. Local.
std::string progress_in_words(const ReportData& data);

/// What the comparison with the recordings says: how many recorded values lie inside the seed
/// scatter and which, and the largest difference of each observable. Plain text, "" when nothing
/// of that kind is recorded. Local.
/// @param kind "lab" or "paper_dem"
std::string result_in_words(const ReportData& data, const Analysis& analysis,
                            const std::string& kind);

/// Which of pull, gross tractive effort and sinkage still rise or fall within the averaging
/// windows, in how many runs. Plain text, "" when all are steady. Local.
std::string drift_in_words(const Analysis& analysis);

}  // namespace grouser
