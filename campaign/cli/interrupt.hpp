// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <signal.h>

namespace grouser {

/// While it lives, INT and TERM set a flag, and interrupt a sleep, instead of ending the program.
class InterruptGuard {
 public:
  InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  ~InterruptGuard();

  /// Whether a signal came since the newest guard began.
  static bool is_interrupted();

 private:
  struct sigaction old_int_ {};
  struct sigaction old_term_ {};
};

}  // namespace grouser
