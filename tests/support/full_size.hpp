// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>

namespace grouser {

/// Whether tests that are reduced for every day are wanted at their full size:
/// GROUSER_FULL_SIZE=1 in the environment.
inline bool full_size() { return std::getenv("GROUSER_FULL_SIZE") != nullptr; }

}  // namespace grouser
