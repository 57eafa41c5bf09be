// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/lbm/averaged.hpp"
#include "engine/lbm/streaming.hpp"

namespace grouser {

/// The sweep that is due of a volume-averaged flow: see AveragedFields. D3Q19 in double precision.
/// Local.
/// @param force uniform body force density beside the fields' push
template <class Set>
void sweep_averaged(Streaming<Set, double>& streaming, const TwoRates<double>& collision,
                    const Vec3& force, const SweepRange& range, AveragedFields& fields);

}  // namespace grouser
