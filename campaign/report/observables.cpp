// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/observables.hpp"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr bool table_is_in_order() {
  for (std::size_t i = 0; i < kObservableCount; ++i)
    if (index_of(kObservables[i].id) != i) return false;
  return true;
}
static_assert(table_is_in_order(), "kObservables must follow the enumerators");

}  // namespace

std::optional<Observable> find_observable(const std::string& name) {
  for (const ObservableEntry& entry : kObservables)
    if (name == entry.name) return entry.id;
  return std::nullopt;
}

std::optional<SlipDefinition> find_slip_definition(const std::string& word) {
  if (word == "powered") return SlipDefinition::kPowered;
  if (word == "bounded") return SlipDefinition::kBounded;
  return std::nullopt;
}

const char* formula_of(SlipDefinition definition) {
  return definition == SlipDefinition::kPowered ? "i = 1 − v/(ωr)" : "s = (ωr − v)/max(ωr, v)";
}

double slip_of(SlipDefinition definition, double rim_speed, double forward_speed) {
  if (definition == SlipDefinition::kPowered)
    return rim_speed > 0.0 ? 1.0 - forward_speed / rim_speed : kNaN;
  const double faster = std::max(rim_speed, forward_speed);
  return faster > 0.0 ? (rim_speed - forward_speed) / faster : kNaN;
}

double convert_slip(double slip, SlipDefinition from, SlipDefinition to) {
  if (from == to || slip >= 0.0 || std::isnan(slip)) return slip;
  if (from == SlipDefinition::kBounded) return slip > -1.0 ? slip / (1.0 + slip) : kNaN;
  return slip / (1.0 - slip);
}

}  // namespace grouser
