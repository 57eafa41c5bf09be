// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kDragInertia{
    "drag_inertia",
    Family::kPhysics,
    "Drag above Stokes' (inertia of the fluid)",
    {{theory(Setting::kDragInertia)}},
    1,
    {},
    {"whole fall; terminal speed too low",
     "Re^0.687: negligible below Re 0.1, 15 % at Re 1, doubles the drag at Re 16",
     "viscosity, side wall, gain", "terminal speeds at three Reynolds numbers in one container"}};

}  // namespace grouser::diagnosis
