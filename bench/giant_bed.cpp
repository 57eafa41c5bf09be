// SPDX-License-Identifier: BSD-3-Clause
#include "bench/giant_bed.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/process_memory.hpp"
#include "engine/app/setup.hpp"
#include "engine/io/checkpoint.hpp"

namespace grouser::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point from) {
  return std::chrono::duration<double>(Clock::now() - from).count();
}

// An even tile is the bed shifted, an odd one its mirror image.
double tiled(double at, int tile, double length) {
  return length * tile + (tile % 2 == 0 ? at : length - at);
}

World giant_world(const Communicator& ranks, const Case& input, const GiantOptions& options) {
  const World users = make_world(ranks, input);
  WorldSettings settings = users.settings();
  settings.skin = options.skin;
  World world(ranks, settings);
  const Body& box = users.body(kBoxBody);
  world.add_body(box.name, box.search->mesh(), box.solid, box.surface, box.turns);
  return world;
}

void fill(World& world, const std::vector<Particle>& bed, const GiantOptions& options,
          double length, double width) {
  const auto tiles =
      static_cast<std::size_t>(options.tiles_x) * static_cast<std::size_t>(options.tiles_y);
  world.reserve(bed.size() * tiles / static_cast<std::size_t>(world.ranks().size()));
  std::int64_t id = 0;
  for (int x = 0; x < options.tiles_x; ++x)
    for (int y = 0; y < options.tiles_y; ++y)
      for (const Particle& grain : bed) {
        Particle p = grain;
        p.id = id++;
        p.position.x = tiled(grain.position.x, x, length);
        p.position.y = tiled(grain.position.y, y, width);
        if (world.owns(p.position)) world.add_particle(p);
      }
}

double step(World& world, std::int64_t steps) {
  world.ranks().barrier();
  const auto from = Clock::now();
  for (std::int64_t s = 0; s < steps; ++s)
    if (world.step().fault != Fault::kNone) throw std::runtime_error("the bed broke down");
  return world.ranks().max(seconds_since(from));
}

}  // namespace

void run_giant(const Communicator& ranks, Case input, const std::vector<Particle>& bed,
               const GiantOptions& options) {
  const double length = input.box.length;
  const double width = input.box.width;
  input.box.length *= options.tiles_x;
  input.box.width *= options.tiles_y;
  input.contact.rolling = options.rolls ? "elastic_plastic" : "none";
  input.numerics.time_step = options.time_step;
  nlohmann::ordered_json out;
  malloc_trim(0);
  const std::int64_t before = resident_bytes();
  forget_peak();
  double count = 0.0;
  const auto note_peak = [&](const char* name) {
    const auto bytes = static_cast<double>(ranks.sum(peak_resident_bytes() - before));
    out[name] = bytes / count;
    forget_peak();
  };

  CheckpointStore store(ranks, options.room);
  std::uint64_t straight = 0;
  CheckpointManifest manifest;
  {
    World world = giant_world(ranks, input, options);
    auto from = Clock::now();
    fill(world, bed, options, length, width);
    count = static_cast<double>(world.particle_count());
    out["particles"] = world.particle_count();
    out["ranks"] = ranks.size();
    out["generate_seconds"] = ranks.max(seconds_since(from));
    note_peak("bytes_per_particle_generating");
    out["first_step_seconds"] = step(world, 1);
    note_peak("bytes_per_particle_first_step");
    out["particle_steps_per_s"] =
        count * static_cast<double>(options.steps) / step(world, options.steps);
    note_peak("bytes_per_particle_stepping");
    out["contacts_per_particle"] = static_cast<double>(world.contacts()) / count;

    manifest.case_key = "giant";
    manifest.step = options.steps;
    from = Clock::now();
    const auto piece = [&](const StatePiece& wanted) {
      State state;
      world.save_state(state, wanted);
      return state;
    };
    const std::int64_t pieces = store.pieces_for(world.particle_count());
    manifest = *store.write(piece, pieces, manifest, [] { return true; });
    const double seconds = ranks.max(seconds_since(from));
    out["checkpoint_bytes"] = manifest.bytes;
    out["checkpoint_seconds"] = seconds;
    out["checkpoint_MB_per_s"] = 1e-6 * static_cast<double>(manifest.bytes) / seconds;
    note_peak("bytes_per_particle_checkpoint");

    step(world, options.steps);
    StateHash hash;
    for (std::int64_t p = 0; p < pieces; ++p)
      for (const StateTable& rows : piece({p, pieces})) hash.add(rows);
    straight = hash.value(ranks);
    forget_peak();
  }
  malloc_trim(0);
  World world = giant_world(ranks, input, options);
  const auto from = Clock::now();
  world.begin_load();
  store.read(manifest, [&](const StateTable& rows) { world.load_rows(rows); });
  world.end_load();
  out["restart_seconds"] = ranks.max(seconds_since(from));
  note_peak("bytes_per_particle_restart");
  step(world, options.steps);
  note_peak("bytes_per_particle_after_restart");
  const std::int64_t pieces = store.pieces_for(world.particle_count());
  StateHash hash;
  for (std::int64_t p = 0; p < pieces; ++p) {
    State state;
    world.save_state(state, {p, pieces});
    for (const StateTable& rows : state) hash.add(rows);
  }
  out["same_bits_after_restart"] = hash.value(ranks) == straight;
  if (ranks.rank() == 0) std::cout << out.dump(1) << std::endl;
}

}  // namespace grouser::bench
