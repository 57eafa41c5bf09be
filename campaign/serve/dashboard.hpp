// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// The page, its script and its style, kept as files of their own and put into the program.
extern const char* const kDashboardHtml;
extern const char* const kDashboardJs;
extern const char* const kDashboardCss;

}  // namespace grouser
