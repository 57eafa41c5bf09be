// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <variant>

#include "engine/dem/laws/hertz_mindlin.hpp"
#include "engine/dem/laws/rolling.hpp"

namespace grouser {

/// The laws a case can name. A new law is one file and one word in its list here; loops over
/// contacts are templates over the pair of laws and meet every combination by themselves.
using ContactLaw = std::variant<HertzMindlin>;
using RollingLaw = std::variant<NoRolling, ElasticPlasticRolling>;

/// The law called `name` with these solids and this surface; the first of the list when the name is
/// unknown, which the case reader has already refused. Local.
ContactLaw make_contact_law(const std::string& name, const Solid& a, const Solid& b,
                            const Surface& surface);
RollingLaw make_rolling_law(const std::string& name, const Surface& surface);

}  // namespace grouser
