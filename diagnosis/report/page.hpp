// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "diagnosis/inference/diagnose.hpp"

namespace grouser::diagnosis {

/// One diagnosis as one HTML file: no script, nothing loaded from elsewhere, all text of users
/// escaped; in the style of the campaign's report. Local.
std::string page_html(const Diagnosis& d, const SeriesRecording& recording);

}  // namespace grouser::diagnosis
