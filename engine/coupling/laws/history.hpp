// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "engine/coupling/fluid.hpp"

namespace grouser {

/// History force: -3 pi mu d times the integral of K(t - s) d(v - u)/ds ds, where
/// K(t) = d / sqrt(4 pi nu t) (1 + (t/T)^(3/4))^-2. `memory(at)` is T [s], the time after which
/// convection has carried the wake's vorticity away; infinite for Basset's kernel.

/// Creeping flow: K falls as t^(-1/2) for ever.
struct BassetHistory {
  static constexpr const char* kName = "basset";
  static constexpr const char* kSource = "Boussinesq 1885; Basset 1888";
  static double memory(const FluidPoint& /*at*/) { return std::numeric_limits<double>::infinity(); }
};

/// Reynolds numbers up to about 100: K falls as t^-2 at last. The slip of the moment stands for
/// that of all of the history.
struct MeiAdrianHistory {
  static constexpr const char* kName = "mei_adrian";
  static constexpr const char* kSource = "Mei and Adrian 1992; Mei 1994";
  static double memory(const FluidPoint& at) {
    // K = ((4 pi nu t/d^2)^(1/4) + (pi |u|^3 t^2/(d nu f^3))^(1/2))^-2, f = 0.75 + 0.105 Re.
    const double speed = norm(at.slip);
    if (speed == 0.0) return std::numeric_limits<double>::infinity();
    const double diffusivity = at.fluid.viscosity / at.fluid.density;
    const double f = 0.75 + 0.105 * at.reynolds();
    const double diffusion = 4.0 * std::numbers::pi * diffusivity / (at.diameter * at.diameter);
    const double convection =
        std::numbers::pi * speed * speed * speed / (at.diameter * diffusivity * f * f * f);
    return std::cbrt(diffusion / (convection * convection));
  }
};

}  // namespace grouser
