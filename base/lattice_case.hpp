// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/schema.hpp"

namespace grouser {

/// What the fluid meets at one side of the lattice.
struct LatticeFaceCase {
  std::string kind = "wall";  ///< "wall", "slip", "periodic", "velocity", "pressure", "outflow"
  double velocity_x = 0.0;    ///< of a wall, or of the fluid at kind velocity [m s-1]
  double velocity_y = 0.0;    ///< [m s-1]
  double velocity_z = 0.0;    ///< [m s-1]
  double pressure = 0.0;      ///< beyond that of the fluid at rest, at kind pressure [Pa]
};

/// Keys of the six sides, low and high of x, y and z.
inline constexpr std::array<const char*, 6> kLatticeFaces = {"x_low",  "x_high", "y_low",
                                                             "y_high", "z_low",  "z_high"};

/// The lattice that a fluid is computed on: docs/physics/coupling.md.
struct LatticeCase {
  double cell = 0.0;             ///< side of a cell [m]
  double height = 0.0;           ///< of the fluid over the floor; 0 = box.depth [m]
  double speed = 0.0;            ///< largest that is expected of fluid or grains [m s-1]
  double mach = 0.1;             ///< of that speed [1]; sets the step unless relaxation_time does
  double relaxation_time = 0.0;  ///< 0 = from speed and mach [1]
  std::string velocities = "D3Q19";
  std::string collision = "trt";
  std::string precision = "double";
  double smagorinsky = 0.15;    ///< for collision les [1]
  double acceleration_x = 0.0;  ///< body force over density [m s-2]
  double acceleration_y = 0.0;  ///< [m s-2]
  double acceleration_z = 0.0;  ///< [m s-2]
  std::array<LatticeFaceCase, 6> faces{};
};

/// See FieldVisitor.
void describe(FieldVisitor& visitor, LatticeCase& lattice);

}  // namespace grouser
