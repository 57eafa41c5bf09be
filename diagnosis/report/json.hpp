// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "diagnosis/inference/diagnose.hpp"

namespace grouser::diagnosis {

/// The answer as JSON text. Format: docs/reference/formats/diagnosis.md. Local.
std::string to_json(const Diagnosis& diagnosis);

/// One sentence that says the verdict with its odds. Local.
std::string sentence(const Diagnosis& diagnosis);

}  // namespace grouser::diagnosis
