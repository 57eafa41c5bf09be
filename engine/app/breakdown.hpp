// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "base/case.hpp"
#include "engine/app/energy_ledger.hpp"
#include "engine/coupling/resolved_flow.hpp"
#include "engine/dem/world.hpp"
#include "engine/terrain/wheel.hpp"

namespace grouser {

/// What makes going on after a step meaningless: what, where, why and what to do, in one line; or
/// nothing. The same on any number of ranks. docs/physics/breakdown.md. Collective.
std::optional<std::string> breakdown_of(const World& world, const World::StepResult& result,
                                        const Case& input);

/// The same for the fluid on a lattice: numbers that are none, or speeds at which it is no fluid
/// any more. Walks over all cells. Collective.
std::optional<std::string> breakdown_of(const ResolvedFlow& fluid);

/// The same for grains that heat up; see EnergyLedger. Local.
std::string heating_text(const EnergyLedger& ledger, const World::Survey& survey,
                         const Case& input);

}  // namespace grouser
