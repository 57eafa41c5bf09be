// SPDX-License-Identifier: BSD-3-Clause
#include "base/columns.hpp"

#include <limits>

#include "base/size_curve.hpp"

namespace grouser {
namespace {

// Of the mean grain diameter: wide enough to keep a list for tens of steps of a moving bed.
constexpr double kSkin = 0.1;

}  // namespace

std::optional<Columns> cut_columns(double length, double width, std::int64_t ranks, double reach) {
  const auto fits = [reach](double room, std::int64_t count) {
    return count == 1 || room / static_cast<double>(count) >= reach;
  };
  double best = std::numeric_limits<double>::infinity();
  std::optional<Columns> found;
  for (std::int64_t nx = 1; nx <= ranks && fits(length, nx); ++nx) {
    const std::int64_t ny = ranks / nx;
    if (ranks % nx != 0 || !fits(width, ny)) continue;
    // What the halo traffic follows.
    const double cut = static_cast<double>(nx - 1) * width + static_cast<double>(ny - 1) * length;
    if (cut >= best) continue;
    best = cut;
    found = Columns{static_cast<int>(nx), static_cast<int>(ny)};
  }
  return found;
}

double list_skin(const GrainsCase& grains) { return kSkin * SizeCurve(grains).mean(); }

double list_reach(const GrainsCase& grains) {
  return SizeCurve(grains).largest() + list_skin(grains);
}

}  // namespace grouser
