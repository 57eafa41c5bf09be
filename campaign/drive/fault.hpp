// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// A place at which a test may end the process as `kill -9` would: the environment variable
/// GROUSER_FAULT names the place, or says how many places are passed first. Nothing happens without
/// it. Local.
void fault_point(const char* place);

}  // namespace grouser
