// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/interrupt.hpp"

#include <atomic>

namespace grouser {
namespace {

std::atomic<bool> has_signal{false};

void note_interrupt(int) { has_signal = true; }

}  // namespace

InterruptGuard::InterruptGuard() {
  has_signal = false;
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  ::sigaction(SIGINT, &action, &old_int_);
  ::sigaction(SIGTERM, &action, &old_term_);
}

InterruptGuard::~InterruptGuard() {
  ::sigaction(SIGINT, &old_int_, nullptr);
  ::sigaction(SIGTERM, &old_term_, nullptr);
}

bool InterruptGuard::is_interrupted() { return has_signal; }

}  // namespace grouser
