// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <spdlog/spdlog.h>

namespace grouser {

/// Sets up logging to stderr, one line each: time level rank message. Rank 0 says info and more,
/// the others warnings and more. Call once, before the first message. Local.
void set_up_log(int rank);

}  // namespace grouser
