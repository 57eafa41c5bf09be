// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "engine/lbm/flow.hpp"

namespace grouser {

// One per lattice, each compiled by itself: every one holds sweeps of all collisions, with and
// without force, in both precisions.
std::unique_ptr<Flow> make_d2q9_flow(const Communicator& ranks, const FlowSettings& settings);
std::unique_ptr<Flow> make_d3q15_flow(const Communicator& ranks, const FlowSettings& settings);
std::unique_ptr<Flow> make_d3q19_flow(const Communicator& ranks, const FlowSettings& settings);
std::unique_ptr<Flow> make_d3q27_flow(const Communicator& ranks, const FlowSettings& settings);

}  // namespace grouser
