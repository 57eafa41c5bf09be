// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "targets.hpp"

// One program per target: libFuzzer has its own main.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const auto& target : grouser::kFuzzTargets)
    if (std::string_view(target.name) == FUZZ_TARGET)
      target.read(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
