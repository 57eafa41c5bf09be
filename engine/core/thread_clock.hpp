// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace grouser {

/// Processor time of this thread [s], from any beginning: what work costs, whoever else keeps the
/// processor busy. Local.
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace grouser
