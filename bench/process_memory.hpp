// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

namespace grouser::bench {

/// A line of /proc/self/status in bytes; 0 where there is no such line.
inline std::int64_t status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::int64_t kilobytes = 0;
    if (word == name + ":" && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

inline std::int64_t resident_bytes() { return status_bytes("VmRSS"); }
inline std::int64_t peak_resident_bytes() { return status_bytes("VmHWM"); }

/// Lets the peak begin anew at what is resident now. Where the system refuses, it stands.
inline void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5\n"; }

}  // namespace grouser::bench
