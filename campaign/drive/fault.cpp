// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/fault.hpp"

#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace grouser {

void fault_point(const char* place) {
  const char* const wanted = std::getenv("GROUSER_FAULT");
  if (wanted != nullptr && std::strcmp(wanted, place) == 0) ::kill(::getpid(), SIGKILL);
}

}  // namespace grouser
