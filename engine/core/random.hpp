// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace grouser {

/// A uniform number in [0, 1) that depends only on its arguments, so that any rank can draw the
/// numbers of any particle. Mixing function: Steele, Lea, Flood 2014 (SplitMix64). Local.
inline double random_unit(std::uint64_t seed, std::uint64_t item, std::uint64_t stream) {
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15u;
  const auto mix = [](std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  };
  const std::uint64_t word = mix(mix(mix(seed + kGolden) + item * kGolden) + stream * kGolden);
  return static_cast<double>(word >> 11) * 0x1p-53;
}

}  // namespace grouser
