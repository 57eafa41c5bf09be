// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "diagnosis/hypotheses/hypothesis.hpp"

namespace grouser::diagnosis {

inline constexpr Hypothesis kParameterRestitution{
    "parameter_restitution",
    Family::kParameter,
    "Restitution beyond its uncertainty",
    {},
    0,
    Setting::kRestitution,
    {"after contacts", "the same at every speed", "lubrication, contact damping", "bounce in air"}};

}  // namespace grouser::diagnosis
