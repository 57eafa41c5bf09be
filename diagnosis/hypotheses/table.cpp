// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/hypotheses/table.hpp"

#include <string_view>

namespace grouser::diagnosis {

const char* word_of(Family family) {
  switch (family) {
    case Family::kBaseline:
      return "baseline";
    case Family::kPhysics:
      return "physics";
    case Family::kSensor:
      return "sensor";
    case Family::kParameter:
      return "parameter";
    case Family::kNumerics:
      return "numerics";
    case Family::kImitator:
      return "imitator";
    case Family::kUnknown:
      return "unknown";
  }
  return "unknown";
}

const Hypothesis* find_hypothesis(const char* id) {
  for (const Hypothesis& hypothesis : kHypotheses)
    if (std::string_view(hypothesis.id) == id) return &hypothesis;
  return nullptr;
}

}  // namespace grouser::diagnosis
