// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "engine/terrain/wheel.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {

/// The same on any ranks.
inline std::uint64_t hash_of(const World& world) {
  State state;
  world.save_state(state);
  return hash_state(world.ranks(), state);
}

/// Settings of a world in which everything that remembers is at work.
inline WorldSettings rolling_settings(double skin) {
  WorldSettings settings = small_settings();
  settings.rolling = "elastic_plastic";
  settings.skin = skin;
  settings.time_step = 1e-5;
  return settings;
}

/// A box and, as body 1, a drum of 40 mm width. @return the drum's motion
inline BodyMotion& add_box_and_drum(World& world, double diameter, const Vec3& position) {
  add_box(world, {0.5, 0.4, 0.05});
  WheelCase drum;
  drum.diameter = diameter;
  drum.width = 0.04;
  drum.facets = 36;
  const std::size_t wheel =
      world.add_body("drum", wheel_mesh(drum), kTestSolid, {0.5, 0.6, 0.1}, true);
  world.body(wheel).motion.position = position;
  return world.body(wheel).motion;
}

/// Adds this rank's share of `count` grains, of which grain(i) is one.
template <class Grain>
void add_share(World& world, std::int64_t count, const Grain& grain) {
  const Communicator& ranks = world.ranks();
  for (std::int64_t i = first_key(count, ranks.size(), ranks.rank());
       i < first_key(count, ranks.size(), ranks.rank() + 1); ++i)
    world.add_particle(grain(static_cast<std::size_t>(i)));
}

/// Moves the drum as its velocity and spin say.
inline void move_drum(World& world) {
  BodyMotion& motion = world.body(1).motion;
  motion.position += world.settings().time_step * motion.velocity;
  motion.angle += world.settings().time_step * motion.spin;
}

/// Lets the grains turn and push the drum, so that body loads enter the trajectory.
inline void drive_drum(World& world) {
  BodyMotion& motion = world.body(1).motion;
  motion.spin += world.load(1).moment_y() * world.settings().time_step / 1e-4;
  motion.velocity.x += world.load(1).force_x.value() * world.settings().time_step / 2.0;
  move_drum(world);
}

/// Cuts by few grains that weigh much: boxes change all the time, some are thinner than a grain.
inline void cut_anew(World& world, std::uint64_t seed) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < world.owned(); ++i)
    weights.push_back(
        std::pow(random_unit(seed, static_cast<std::uint64_t>(world.particles()[i].id), 0), 20.0));
  world.cut_by(weights);
}

}  // namespace grouser
