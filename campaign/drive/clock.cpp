// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/clock.hpp"

#include <chrono>
#include <ctime>

namespace grouser {

double SystemClock::now() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double>(since).count();
}

void SystemClock::sleep(double seconds) {
  std::timespec time{};
  time.tv_sec = static_cast<std::time_t>(seconds);
  time.tv_nsec = static_cast<long>((seconds - static_cast<double>(time.tv_sec)) * 1e9);
  ::nanosleep(&time, nullptr);
}

}  // namespace grouser
