// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace grouser {

/// Wall factors: speed of a sphere in a container over its speed in unbounded fluid under the same
/// force, 0 to 1. `ratio` = sphere over container diameter (for a square box, its width), 0 to 1;
/// `reynolds` of the unbounded sphere. Drag in the container at speed U is the unbounded drag at
/// U / factor. For a sphere on the axis of a long cylinder, moving steadily: the walls' effect
/// needs the time it takes vorticity to reach them, (D/2)^2 rho / mu, to establish.

/// No walls.
struct NoWall {
  static constexpr const char* kName = "none";
  static constexpr const char* kSource = "unbounded fluid";
  static constexpr double kLargestRatio = 1.0;
  static double factor(double /*ratio*/, double /*reynolds*/) { return 1.0; }
};

/// Creeping flow in a cylinder by the method of reflections; within 1 % of the exact solution up
/// to a ratio of 0.5.
struct FaxenWall {
  static constexpr const char* kName = "faxen";
  static constexpr const char* kSource = "Faxen 1923, as in Happel and Brenner 1965, section 7-3";
  static constexpr double kLargestRatio = 0.5;
  static double factor(double ratio, double /*reynolds*/) {
    const double r3 = ratio * ratio * ratio;
    return 1.0 - 2.10444 * ratio + 2.08877 * r3 - 0.94813 * r3 * ratio * ratio - 1.372 * r3 * r3 +
           3.87 * r3 * r3 * ratio * ratio - 4.19 * r3 * r3 * r3 * ratio;
  }
};

/// Creeping flow in a cylinder, nearly exact up to a ratio of 0.8.
struct HabermanSayreWall {
  static constexpr const char* kName = "haberman_sayre";
  static constexpr const char* kSource = "Haberman and Sayre 1958";
  static constexpr double kLargestRatio = 0.8;
  static double factor(double ratio, double /*reynolds*/) {
    const double r3 = ratio * ratio * ratio;
    const double r5 = r3 * ratio * ratio;
    return (1.0 - 2.1050 * ratio + 2.0865 * r3 - 1.7068 * r5 + 0.72603 * r3 * r3) /
           (1.0 - 0.75857 * r5);
  }
};

/// Measured, at any Reynolds number: ((1 - ratio)/(1 - 0.33 ratio))^a, a from 3.3 in creeping flow
/// to 0.85 in inertial flow.
struct DiFeliceWall {
  static constexpr const char* kName = "di_felice";
  static constexpr const char* kSource = "Di Felice 1996, Int. J. Multiphase Flow 22, 527";
  static constexpr double kLargestRatio = 0.95;
  static double factor(double ratio, double reynolds) {
    const double exponent = (3.3 + 0.085 * reynolds) / (1.0 + 0.1 * reynolds);
    return std::pow((1.0 - ratio) / (1.0 - 0.33 * ratio), exponent);
  }
};

}  // namespace grouser
