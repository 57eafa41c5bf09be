// SPDX-License-Identifier: BSD-3-Clause
#include "engine/app/setup.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/lattice_units.hpp"
#include "base/list_reach.hpp"
#include "base/size_curve.hpp"
#include "base/time_step.hpp"
#include "engine/terrain/bed.hpp"
#include "engine/terrain/shapes.hpp"

namespace grouser {
namespace {

// Grains thrown up stay in the world up to this far above the walls [m].
constexpr double kHeadroom = 2.0;

Solid solid_of(const Case& input, const SolidCase& s) {
  return {input.contact.stiffness_scale * s.young_modulus, s.poisson_ratio};
}
Surface surface_of(const SurfaceCase& s) { return {s.restitution, s.friction, s.rolling_friction}; }

// Rolling resistance holds grains apart as friction does; both are lowered in the same proportion.
Surface preparation_surface(const Case& input) {
  Surface surface = surface_of(input.contact.grain_grain);
  const double share =
      surface.friction > 0.0 ? input.bed.preparation_friction / surface.friction : 1.0;
  surface.friction = input.bed.preparation_friction;
  surface.rolling_friction *= share;
  return surface;
}

ActivityRule activity_rule(const Case& input) {
  if (!input.has_wheel || input.activity.mode != "sleep") return {};
  return {input.activity.speed * std::sqrt(input.gravity * SizeCurve(input.grains).mean()),
          input.activity.imbalance, input.activity.interval};
}

}  // namespace

World make_world(const Communicator& ranks, const Case& input, int threads) {
  const SizeCurve sizes(input.grains);
  const double walls = input.has_wheel
                           ? input.box.depth + input.wheel.diameter
                           : std::max(input.box.depth, Filling(input).height() + sizes.largest());
  WorldSettings settings;
  settings.threads = threads;
  settings.low = {0.0, 0.0, 0.0};
  settings.high = {input.box.length, input.box.width, walls + kHeadroom};
  settings.top = input.has_wheel ? input.bed.depth : walls;
  settings.gravity = input.gravity;
  settings.time_step = time_step_of(input);
  settings.largest_radius = 0.5 * sizes.largest();
  settings.skin = list_skin(input.grains);
  settings.activity = activity_rule(input);
  settings.law = input.contact.law;
  settings.rolling = input.contact.rolling;
  settings.grain = solid_of(input, input.grains.solid);
  settings.grain_grain = surface_of(input.contact.grain_grain);
  if (!input.has_wheel) settings.grain_grain = preparation_surface(input);

  World world(ranks, settings);
  world.add_body("box", box_mesh(input.box.length, input.box.width, walls),
                 solid_of(input, input.box.solid), surface_of(input.contact.grain_box), false);
  if (input.has_wheel)
    world.add_body("wheel", wheel_mesh(input.wheel), solid_of(input, input.wheel.solid),
                   surface_of(input.contact.grain_wheel), true);
  return world;
}

void log_time_step(const Case& input) {
  spdlog::info("app {}", time_step_text(input));
  if (has_lattice(input)) spdlog::info("app {}", lattice_text(input));
  for (const Problem& one : case_warnings(YamlNode{}, input))
    spdlog::warn("app {} {}; {}", one.key, one.problem, one.hint);
}

namespace {

Particle placed(const PlacedGrain& g, std::int64_t id, double density) {
  Particle p;
  p.id = id;
  p.radius = 0.5 * g.diameter;
  p.mass = density * std::numbers::pi / 6.0 * g.diameter * g.diameter * g.diameter;
  p.position = {g.x, g.y, g.z};
  p.velocity = {g.velocity_x, g.velocity_y, g.velocity_z};
  p.spin = {g.spin_x, g.spin_y, g.spin_z};
  return p;
}

}  // namespace

void fill(World& world, const Case& input) {
  std::int64_t number = 0;
  for (const PlacedGrain& one : input.placed.grains) {
    const Particle grain = placed(one, number++, input.grains.density);
    if (world.owns(grain.position)) world.add_particle(grain);
  }
  if (input.has_placed) return;
  const Filling filling(input);
  // Every rank makes all grains and keeps its own: none has to travel, which would need more memory
  // than stepping does.
  world.reserve(static_cast<std::size_t>(filling.count() / world.ranks().size()));
  for (std::int64_t id = 0; id < filling.count(); ++id) {
    const Particle grain = filling.particle(id);
    if (world.owns(grain.position)) world.add_particle(grain);
  }
}

}  // namespace grouser
