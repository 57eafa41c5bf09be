// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <numbers>

#include "engine/coupling/fluid.hpp"

namespace grouser {

/// Resistance of the fluid film between a grain and a wall, or another grain, to their approach or
/// parting, beyond the drag that the grain feels far away. `excess(gap)` over 6 pi mu R, gap over
/// R; R the grain's radius against a plane wall, a b/(a + b) between two grains. Creeping flow.

/// Leading term of the thin film: R/gap.
struct LeadingLubrication {
  static constexpr const char* kName = "leading";
  static constexpr const char* kSource = "Cox and Brenner 1967; Kim and Karrila 1991";
  static double excess(double gap) { return 1.0 / gap; }
};

/// A sphere towards a plane wall at any distance: a rational form of Brenner's series, off by under
/// 1 % of the whole drag.
struct BrennerLubrication {
  static constexpr const char* kName = "brenner";
  static constexpr const char* kSource = "Brenner 1961; rational form Bevan and Prieve 2000";
  static double excess(double gap) { return (7.0 * gap + 2.0) / (gap * (6.0 * gap + 2.0)); }
};

/// Force over the speed of approach [N s m-1]. Zero beyond `cutoff`, where it begins without a
/// step; below `smallest`, the height of the roughness, it stays what it is there.
/// @param radius R [m] @param gap [m] @param smallest,cutoff over R [1], 0 < smallest < cutoff
template <class Law>
double lubrication_coefficient(const Fluid& fluid, double radius, double gap, double smallest,
                               double cutoff) {
  const double distance = gap / radius;
  if (distance >= cutoff) return 0.0;
  return 6.0 * std::numbers::pi * fluid.viscosity * radius *
         (Law::excess(std::max(distance, smallest)) - Law::excess(cutoff));
}

}  // namespace grouser
