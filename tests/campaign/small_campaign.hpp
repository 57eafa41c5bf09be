// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace grouser {

/// A valid case, indented to stand under `case:`.
inline constexpr const char* kSmallCase = R"(
  box: {length: 40 cm, width: 12 cm, depth: 10 cm}
  grains:
    density: 2650 kg/m3
    size_curve: [{diameter: 0.4 mm, finer: 0 %}, {diameter: 0.8 mm, finer: 100 %}]
    coarse_graining: 12
  contact:
    grain_grain: {restitution: 0.5, friction: 0.5}
    grain_box: {restitution: 0.5, friction: 0.5}
    grain_wheel: {restitution: 0.5, friction: 0.5}
  bed: {depth: 6 cm}
  wheel:
    diameter: 12.5 cm
    width: 6 cm
    load: 24 N
    forward_speed: 20 cm/s
    travel: 4 cm
    average_travel: 2 cm
  output: {checkpoint_interval: 20 ms}
)";

/// Head, case and whatever `rest` adds.
inline std::string small_campaign(const std::string& rest,
                                  const std::string& head = "campaign: small\n") {
  return "grouser: 1\n" + head + "case:" + kSmallCase + rest;
}

inline constexpr const char* kTwoSlips = R"(sweep:
  - axis: slip
    points:
      - {label: towed, set: {wheel.drive: towed}}
      - {label: slip_20, set: {wheel.slip: 20 %}}
)";

}  // namespace grouser
