// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace grouser {

/// Rows under a head line, columns as wide as their longest text. Local.
std::string text_table(const std::vector<std::string>& head,
                       const std::vector<std::vector<std::string>>& rows);

/// "45s", "3m 20s", "2h 05m", "3d 04h". Local.
std::string duration_text(double seconds);

/// Fixed number of significant digits. Local.
std::string short_number(double value, int digits = 4);

/// Local date and time of seconds since 1970, "" for 0. Local.
std::string time_text(double seconds);

}  // namespace grouser
