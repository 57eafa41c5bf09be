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

/// A closed surface as STL text that goes with the small case's wheel: four facets, the farthest
/// corners a diameter of 12.5 cm apart. `name` makes files of other content.
inline std::string small_surface(const std::string& name) {
  const char* const corners[4] = {"0.0625 -0.03 0", "-0.0625 -0.03 0", "0 0.03 0.05",
                                  "0 0.03 -0.05"};
  const int facets[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  std::string text = "solid " + name + "\n";
  for (const auto& facet : facets) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : facet) text += std::string("vertex ") + corners[corner] + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

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
