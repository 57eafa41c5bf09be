// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "engine/core/random.hpp"
#include "engine/dem/world.hpp"
#include "engine/terrain/shapes.hpp"

namespace grouser {

inline constexpr Solid kTestSolid{5e7, 0.25};

inline Particle sphere(std::int64_t id, double radius, const Vec3& position,
                       double density = 2650.0) {
  Particle p;
  p.id = id;
  p.radius = radius;
  p.mass = density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  p.position = position;
  return p;
}

/// Settings for grains of radius up to 5 mm in a box of 0.1 m.
inline WorldSettings small_settings() {
  WorldSettings settings;
  settings.low = {0.0, 0.0, 0.0};
  settings.high = {0.1, 0.1, 0.4};
  settings.time_step = 5e-6;
  settings.largest_radius = 5e-3;
  settings.skin = 1e-3;
  settings.grain = kTestSolid;
  settings.grain_grain = {0.5, 0.5, 0.1};
  return settings;
}

/// Loose random column of grains with radii 3 to 5 mm above the floor of small_settings' box.
inline std::vector<Particle> loose_column(int count, std::uint64_t seed) {
  std::vector<Particle> grains;
  const int per_layer = 81;
  for (int i = 0; i < count; ++i) {
    const auto item = static_cast<std::uint64_t>(i);
    const auto draw = [&](std::uint64_t stream) { return random_unit(seed, item, stream); };
    const double radius = 3e-3 + 2e-3 * draw(0);
    const double pitch = 0.1 / 9.0;
    const double free = pitch - 2.0 * radius;
    const int slot = i % per_layer;
    grains.push_back(sphere(
        i, radius,
        {(slot % 9) * pitch + radius + free * draw(1), (slot / 9) * pitch + radius + free * draw(2),
         (i / per_layer) * pitch + radius + free * draw(3)}));
    grains.back().velocity = {draw(4) - 0.5, draw(5) - 0.5, draw(6) - 0.5};
  }
  return grains;
}

inline void add_box(World& world, const Surface& surface) {
  const Vec3 high = world.settings().high;
  world.add_body("box", box_mesh(high.x, high.y, high.z), kTestSolid, surface, false);
}

}  // namespace grouser
