// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/coupling/fluid.hpp"

namespace grouser {

/// Force of the undisturbed pressure field on a grain, -V grad p [N]; buoyancy where p is
/// hydrostatic, grad p = rho g. @param gradient of the pressure [Pa m-1]
/// Source: Maxey and Riley 1983. Neglected: change of the gradient over the grain.
inline Vec3 pressure_force(const FluidPoint& at, const Vec3& gradient) {
  return -at.volume() * gradient;
}

/// Force of the undisturbed viscous stress on a grain, V div tau [N]; zero in a uniform or linear
/// flow. @param divergence of the viscous stress [Pa m-1]
/// Source: Maxey and Riley 1983. Stress is positive in tension.
inline Vec3 viscous_force(const FluidPoint& at, const Vec3& divergence) {
  return at.volume() * divergence;
}

}  // namespace grouser
