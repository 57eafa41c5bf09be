// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "base/case.hpp"

namespace grouser {

/// Mean overlap over the grain radius [1] that the case's stress gives: `pressure` [Pa] carried by
/// equal spheres at six contacts each. The harder pressed of bed floor and wheel; the wheel's load
/// is taken to rest on its width times half its radius (an entry angle of 30 degrees).
/// Source: force per contact Rumpf 1958, overlap Hertz 1882; docs/physics/contact_laws.md.
struct ExpectedOverlap {
  double pressure = 0.0;  ///< [Pa]
  double overlap = 0.0;   ///< [1]
};
ExpectedOverlap expected_overlap(const Case& input);

/// What contact.stiffness_scale below 1 does, at its place in `node`; nothing for 1. Local.
std::vector<Problem> stiffness_warnings(const YamlNode& node, const Case& input);

}  // namespace grouser
