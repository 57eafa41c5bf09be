// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "base/case.hpp"

namespace grouser {

/// A regular grid of columns over x and y, one to each rank.
struct Columns {
  int x = 1;
  int y = 1;
};

/// The grid with the shortest cuts whose columns are at least `reach` wide; nothing when there is
/// none for this number of ranks. @param length,width of the box along x and y [m]
std::optional<Columns> cut_columns(double length, double width, std::int64_t ranks, double reach);

/// Margin of the neighbour lists of a case [m].
double list_skin(const GrainsCase& grains);

/// How far two grains of a case may be apart and still be each other's neighbours [m].
double list_reach(const GrainsCase& grains);

}  // namespace grouser
