// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "base/case.hpp"

namespace grouser {

/// Margin of the neighbour lists of a case [m].
double list_skin(const GrainsCase& grains);

/// How far two grains of a case may be apart and still be each other's neighbours [m].
double list_reach(const GrainsCase& grains);

/// Ranks that are sensible for a bed of these sides: each has room for a cube of edge `reach`. More
/// would compute little but copies of each other's grains. All lengths in [m].
std::int64_t most_ranks(double length, double width, double depth, double reach);

}  // namespace grouser
