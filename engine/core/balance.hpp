// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "engine/core/communicator.hpp"
#include "engine/core/decomposition.hpp"

namespace grouser {

/// Something that costs time, and where it is.
struct Load {
  Vec3 position;        ///< [m]
  double weight = 0.0;  ///< finite, not negative; in any unit that is the same on all ranks
};

/// Boxes, one to each rank, whose loads are as equal as cuts between loads make them: Zoltan's
/// recursive bisection across the longest side. Boxes may be of any width. The same on all ranks.
/// @param loads of this rank, wherever they are
/// @return nothing when loads are too few, or too many of them in one place, for each rank to get
///         some
/// Collective.
std::optional<Decomposition> balanced(const Communicator& ranks, const std::vector<Load>& loads);

}  // namespace grouser
