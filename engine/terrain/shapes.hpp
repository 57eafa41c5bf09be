// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/case.hpp"
#include "engine/dem/mesh.hpp"

namespace grouser {

/// Open-topped box with its inner lower corner at the origin: floor and four walls of two facets
/// each. @param length,width,height along x, y, z [m]
Mesh box_mesh(double length, double width, double height);

/// Cross-section of a wheel in its x-z plane around the axle, one turn, in order [m]. The outermost
/// points lie on the wheel's diameter. Empty for profile "stl".
std::vector<Vec3> wheel_outline(const WheelCase& wheel);

/// Closed surface of a wheel: the outline drawn out along y to the wheel's width, both sides
/// closed; or the case's STL surface. The axle is the y axis through the origin.
/// @throws ConfigError when the STL file cannot be used
Mesh wheel_mesh(const WheelCase& wheel);

}  // namespace grouser
