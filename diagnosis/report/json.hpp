// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "diagnosis/inference/diagnose.hpp"

namespace grouser::diagnosis {

/// The answer as JSON text. Format: docs/reference/formats/diagnosis.md. Local.
std::string to_json(const Diagnosis& diagnosis);

/// The verdict with its odds, and how far it may be trusted: of a method that is not calibrated,
/// the false alarms of its development and where they are documented. Local.
std::string sentence(const Diagnosis& diagnosis);

}  // namespace grouser::diagnosis
