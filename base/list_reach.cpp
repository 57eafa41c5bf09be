// SPDX-License-Identifier: BSD-3-Clause
#include "base/list_reach.hpp"

#include <algorithm>
#include <cmath>

#include "base/size_curve.hpp"

namespace grouser {
namespace {

// Of the mean grain diameter: wide enough to keep a list for tens of steps of a moving bed.
constexpr double kSkin = 0.1;

}  // namespace

double list_skin(const GrainsCase& grains) { return kSkin * SizeCurve(grains).mean(); }

double list_reach(const GrainsCase& grains) {
  return SizeCurve(grains).largest() + list_skin(grains);
}

std::int64_t most_ranks(double length, double width, double depth, double reach) {
  double most = 1.0;
  for (const double side : {length, width, depth}) most *= std::max(1.0, std::floor(side / reach));
  return static_cast<std::int64_t>(std::min(most, 1e9));
}

}  // namespace grouser
