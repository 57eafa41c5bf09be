// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/case.hpp"
#include "engine/dem/world.hpp"

namespace grouser {

/// Text of slice.csv (docs/reference/formats/run_directory.md) on rank 0, empty elsewhere: grains
/// near the mid-plane by id, the wheel's outline, the box. Collective.
std::string slice_text(const World& world, const Case& input);

}  // namespace grouser
