// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/case.hpp"
#include "engine/core/particle.hpp"

namespace grouser::bench {

/// The rest of a bed in a few numbers; contacts are those between grains.
struct BedMeasure {
  double kinetic_energy = 0.0;  ///< translation and rotation [J]
  double coordination = 0.0;    ///< contacts that a grain has on average [1]
  double mean_overlap = 0.0;    ///< over contacts [m]
  double mean_radius = 0.0;     ///< effective, over contacts [m]
  double mean_mass = 0.0;       ///< effective, over contacts [kg]
};

BedMeasure measure_bed(const std::vector<Particle>& grains, const Case& input);

}  // namespace grouser::bench
