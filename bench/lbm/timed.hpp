// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include "engine/core/communicator.hpp"

namespace grouser::bench {

/// Seconds that the slowest rank takes for `work`. Collective.
template <class Work>
double timed(const Communicator& ranks, const Work& work) {
  ranks.barrier();
  const auto begin = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  return ranks.max(taken.count());
}

}  // namespace grouser::bench
