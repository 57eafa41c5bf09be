// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

namespace grouser {

/// Colour in sRGB, each part 0 to 1.
using Colour = std::array<double, 3>;

/// Sequential colour map, dark violet over teal to pale yellow: equal steps of `share` are equal
/// steps of perceived lightness, so it also reads in grey and with any kind of colour blindness.
/// @param share 0 to 1, clamped; NaN counts as 0. Local.
/// Source: path through the Oklab colour space (Ottosson 2020), lightness linear in `share`.
Colour colour_at(double share);

/// Perceived lightness in Oklab, 0 to 1. Local.
double lightness_of(const Colour& colour);

/// As "#rrggbb". Local.
std::string hex_of(const Colour& colour);

}  // namespace grouser
