// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace grouser {

/// Reads a number with its unit, such as `71.27 cm`, `42 lbf`, `66 in/s`, `20 %`, `8h` or, for a
/// duration, `08:00:00`, and returns it in `si_unit`. A bare number is taken only where `si_unit`
/// is "1" (dimensionless): a length without a unit is a mistake, not a metre.
/// @param text     number, optional blank, unit as UDUNITS-2 spells it
/// @param si_unit  UDUNITS-2 unit of the result, "1" for a pure number
/// @throws std::invalid_argument with one sentence saying what is wrong. Local.
double parse_quantity(const std::string& text, const std::string& si_unit);

/// `value` with all 17 significant digits (reads back to the same bits) and its unit. Local.
std::string format_quantity(double value, const std::string& si_unit);

/// Shortest decimal text that reads back to the same double. Local.
std::string format_number(double value);

/// For messages: three digits tell enough. Local.
std::string rounded(double value);

}  // namespace grouser
