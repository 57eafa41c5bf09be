// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "base/case.hpp"
#include "base/hash.hpp"

namespace grouser {

/// What the stand-in engine computes in place of physics: a number generator that starts from the
/// case, and from the settled bed's number if there is one.
struct FakeState {
  static constexpr double kTimeStep = 1e-3;  ///< [s]

  std::int64_t step = 0;
  std::uint64_t value = 0;

  static FakeState start(const Case& input, const std::optional<FakeState>& bed) {
    return {0, std::stoull(content_key(input), nullptr, 16) ^ (bed ? bed->value : 0)};
  }
  /// The step at which the run is done; a bed settles when its case says so, in its own way.
  static std::int64_t last_step(const Case& input) {
    const double duration = run_duration(input);
    if (duration > 0.0) return static_cast<std::int64_t>(std::ceil(duration / kTimeStep - 1e-9));
    return 120 + static_cast<std::int64_t>(std::stoull(content_key(input), nullptr, 16) % 40);
  }
  void advance() {
    value = value * 6364136223846793005ULL + 1442695040888963407ULL;
    ++step;
  }
  double time() const { return static_cast<double>(step) * kTimeStep; }
  std::string text() const { return std::to_string(step) + " " + std::to_string(value) + "\n"; }
  std::string hash() const { return hash_text(text()); }

  /// The end of a run that nothing disturbed.
  static FakeState end(const Case& input, const std::optional<FakeState>& bed) {
    FakeState state = start(input, bed);
    while (state.step < last_step(input)) state.advance();
    return state;
  }
};

}  // namespace grouser
