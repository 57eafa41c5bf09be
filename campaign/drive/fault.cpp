// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/fault.hpp"

#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace grouser {

void fault_point(const char* place) {
  const char* const wanted = std::getenv("GROUSER_FAULT");
  if (wanted == nullptr) return;
  static int reached = 0;
  ++reached;
  // A number: that many places are passed first, wherever they are.
  const bool is_number = *wanted >= '0' && *wanted <= '9';
  if (is_number ? reached > std::atoi(wanted) : std::strcmp(wanted, place) == 0)
    ::kill(::getpid(), SIGKILL);
}

}  // namespace grouser
