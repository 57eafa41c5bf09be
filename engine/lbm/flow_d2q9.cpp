// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/flow_makers.hpp"
#include "engine/lbm/flow_of.hpp"

namespace grouser {

std::unique_ptr<Flow> make_d2q9_flow(const Communicator& ranks, const FlowSettings& settings) {
  if (settings.precision == Precision::kSingle)
    return std::make_unique<FlowOf<D2Q9, float>>(ranks, settings);
  return std::make_unique<FlowOf<D2Q9, double>>(ranks, settings);
}

}  // namespace grouser
