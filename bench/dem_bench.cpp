// SPDX-License-Identifier: BSD-3-Clause
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/log.hpp"
#include "base/yaml.hpp"
#include "bench/bed_file.hpp"
#include "bench/bed_measure.hpp"
#include "bench/giant_bed.hpp"
#include "bench/process_memory.hpp"
#include "bench/wheel_bed.hpp"
#include "engine/app/setup.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/terrain/bed.hpp"

namespace grouser::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Of the timed runs of all codes.
constexpr double kTimeStep = 2e-6;  // [s]
constexpr double kSkin = 0.2e-3;    // [m]

Case read_bench_case(const fs::path& directory) {
  std::vector<Problem> problems;
  Case input = read_case(load_yaml(directory / run_files::kCase), problems);
  if (!problems.empty()) throw ConfigError(problems);
  input.wheel.stl_file = (directory / input.wheel.stl_file).string();
  return input;
}

// The world that the engine itself would make of the case, but for the skin.
World bench_world(const Communicator& ranks, const Case& input, int threads = 1,
                  double uneven = WorldSettings{}.uneven) {
  const World users = make_world(ranks, input);
  WorldSettings settings = users.settings();
  settings.skin = kSkin;
  settings.threads = threads;
  settings.uneven = uneven;
  World world(ranks, settings);
  for (std::size_t b = 0; b < users.bodies(); ++b) {
    const Body& body = users.body(b);
    world.add_body(body.name, body.search->mesh(), body.solid, body.surface, body.turns);
  }
  return world;
}

void add_share(World& world, const std::vector<Particle>& grains) {
  const auto count = static_cast<std::int64_t>(grains.size());
  const Communicator& ranks = world.ranks();
  const std::int64_t last = first_key(count, ranks.size(), ranks.rank() + 1);
  for (std::int64_t i = first_key(count, ranks.size(), ranks.rank()); i < last; ++i)
    world.add_particle(grains[static_cast<std::size_t>(i)]);
}

void step(World& world, std::int64_t steps) {
  for (std::int64_t s = 0; s < steps; ++s) {
    if (world.step().fault != Fault::kNone) throw std::runtime_error("the bed broke down");
    for (std::size_t b = 0; b < world.bodies(); ++b) {
      BodyMotion& motion = world.body(b).motion;
      motion.position += world.settings().time_step * motion.velocity;
      motion.angle += world.settings().time_step * motion.spin;
    }
  }
}

// Grains of all ranks by id; on rank 0 alone.
std::vector<Particle> gather(const World& world) {
  std::vector<Bytes> out(static_cast<std::size_t>(world.ranks().size()));
  append_bytes(out[0], world.particles().data(), world.owned());
  std::vector<Particle> all;
  for (const Bytes& message : world.ranks().exchange_all(out)) {
    ByteReader reader(message);
    while (!reader.empty()) reader.take(&all.emplace_back(), 1);
  }
  std::sort(all.begin(), all.end(),
            [](const Particle& a, const Particle& b) { return a.id < b.id; });
  return all;
}

// What all codes start from: the grains, and what the decks of the peers need to know. They start
// from rest: a single grain still falling somewhere would make every code renew its lists.
void write_start(const fs::path& directory, const Case& input, std::vector<Particle> grains,
                 double surface) {
  for (Particle& p : grains) p.velocity = p.spin = Vec3{};
  write_bed(directory / "bed.txt", grains);
  write_data_file(directory / "bed.data", input, grains);
  std::ofstream file(directory / "parameters.in");
  file.precision(17);
  const auto put = [&](const char* name, double value) {
    file << "variable " << name << " equal " << value << '\n';
  };
  const BedMeasure bed = measure_bed(grains, input);
  put("length", input.box.length);
  put("width", input.box.width);
  put("gravity", input.gravity);
  put("density", input.grains.density);
  put("young", input.grains.solid.young_modulus);
  put("poisson", input.grains.solid.poisson_ratio);
  put("restitution", input.contact.grain_grain.restitution);
  put("friction", input.contact.grain_grain.friction);
  put("rolling_friction", input.contact.grain_grain.rolling_friction);
  put("damping", HertzMindlin::damping_for(input.contact.grain_grain.restitution));
  put("dt", kTimeStep);
  put("skin", kSkin);
  put("mean_overlap", bed.mean_overlap);
  put("mean_radius", bed.mean_radius);
  put("mean_mass", bed.mean_mass);
  if (!input.has_wheel) return;
  const BodyMotion motion = wheel_motion(input, surface);
  put("axle_x", motion.position.x);
  put("axle_y", motion.position.y);
  put("axle_z", motion.position.z);
  put("wheel_speed", motion.velocity.x);
  put("wheel_spin", motion.spin);
}

void export_bed(const Communicator& ranks, const fs::path& directory) {
  const Case input = read_bench_case(directory);
  CheckpointStore store(ranks, directory / run_files::kCheckpoints);
  const auto found = store.find_newest(content_key(input));
  if (!found || !found->settled_bed) throw FormatError("no settled bed in " + directory.string());
  World world = bench_world(ranks, input);
  world.begin_load();
  store.read(*found, [&](const StateTable& rows) { world.load_rows(rows); });
  world.end_load();
  write_start(directory, input, gather(world), 0.0);
}

// Puts the wheel into a settled bed: grains in its way are taken out, the rest may settle again.
void sink_wheel(const Communicator& ranks, const fs::path& bed, const fs::path& directory) {
  if (ranks.rank() == 0) write_wheel(directory / "wheel.stl", read_bench_case(directory));
  ranks.barrier();
  const Case input = read_bench_case(directory);
  std::vector<Particle> grains = read_bed(bed / "bed.txt", input.grains.density);
  World empty = bench_world(ranks, bed_case(input));
  add_share(empty, grains);
  const double surface = surface_level(empty, 0.0, input.box.length, 0.0, input.box.width);

  World world = bench_world(ranks, input);
  BodyMotion& wheel = world.body(1).motion;
  wheel.position = wheel_motion(input, surface).position;
  remove_under_wheel(grains, input, wheel.position);
  add_share(world, grains);
  const double count = static_cast<double>(grains.size());
  // Grains fall into gaps of a grain's radius first.
  const double fall = std::sqrt(2.0 * world.settings().largest_radius / input.gravity);
  for (double time = 0.0; time < fall || world.kinetic_energy() / count > settled_energy(input);) {
    constexpr std::int64_t kSteps = 500;
    step(world, kSteps);
    time += static_cast<double>(kSteps) * world.settings().time_step;
  }
  const std::vector<Particle> settled = gather(world);
  if (ranks.rank() == 0) write_start(directory, input, settled, surface);
}

struct TimeOptions {
  fs::path directory;
  fs::path state;
  std::int64_t steps = 0;
  std::int64_t warm_up = 0;
  bool rolls = false;
  int threads = 1;
  double uneven = WorldSettings{}.uneven;
};

// Every code starts from the grains alone, without contact histories, which the peers cannot read;
// friction takes hold anew during the warm-up.
void time_steps(const Communicator& ranks, const TimeOptions& options) {
  const std::int64_t before = resident_bytes();
  Case input = read_bench_case(options.directory);
  input.contact.rolling = options.rolls ? "elastic_plastic" : "none";
  input.numerics.time_step = kTimeStep;
  World world = bench_world(ranks, input, options.threads, options.uneven);
  {
    const auto grains = read_bed(options.directory / "bed.txt", input.grains.density);
    add_share(world, grains);
  }
  if (input.has_wheel)
    world.body(1).motion = read_wheel_motion(options.directory / "parameters.in");
  const std::int64_t loading_peak = peak_resident_bytes();
  malloc_trim(0);
  forget_peak();
  step(world, options.warm_up);

  ranks.barrier();
  const auto from = Clock::now();
  step(world, options.steps);
  const double seconds = ranks.max(std::chrono::duration<double>(Clock::now() - from).count());

  const std::int64_t peak = peak_resident_bytes();
  const std::int64_t all_peaks = ranks.sum(std::max(peak, loading_peak));
  const std::int64_t stepping = ranks.sum(peak - before);
  const std::int64_t contacts = world.contacts();
  const double energy = world.kinetic_energy();
  const std::vector<Particle> grains = gather(world);
  if (ranks.rank() != 0) return;
  if (!options.state.empty()) write_bed(options.state, grains);
  const BedMeasure bed = measure_bed(grains, input);
  const auto count = static_cast<double>(grains.size());
  nlohmann::ordered_json out;
  out["particles"] = grains.size();
  out["steps"] = options.steps;
  out["ranks"] = ranks.size();
  out["threads"] = options.threads;
  out["cuts"] = world.cuts();
  out["seconds"] = seconds;
  out["particle_steps_per_s"] = count * static_cast<double>(options.steps) / seconds;
  out["kinetic_energy_J"] = energy;
  out["coordination"] = bed.coordination;
  out["contacts_with_walls_per_particle"] = static_cast<double>(contacts) / count;
  out["mean_overlap_m"] = bed.mean_overlap;
  out["peak_rss_bytes"] = all_peaks;
  out["bytes_per_particle"] = static_cast<double>(stepping) / count;
  std::cout << out << std::endl;
}

// The same figures for any code's state, by one ruler.
void measure(const fs::path& directory, const fs::path& state) {
  const Case input = read_bench_case(directory);
  std::vector<Particle> grains = read_bed(directory / "bed.txt", input.grains.density);
  read_motion(state, grains);
  const BedMeasure bed = measure_bed(grains, input);
  nlohmann::ordered_json out;
  out["kinetic_energy_J"] = bed.kinetic_energy;
  out["coordination"] = bed.coordination;
  out["mean_overlap_m"] = bed.mean_overlap;
  std::cout << out << std::endl;
}

int run(int argc, char** argv, const Communicator& ranks) {
  CLI::App app{"dem_bench: times the DEM engine on a settled bed"};
  app.require_subcommand(1);
  TimeOptions options;
  fs::path other;
  auto* exporting = app.add_subcommand("export", "write a settled bed's grains; one rank");
  exporting->add_option("RUN_DIR", options.directory)->required();
  auto* sinking = app.add_subcommand("sink", "put the wheel of DIR/case.yaml into a bed");
  sinking->add_option("BED_DIR", other)->required();
  sinking->add_option("DIR", options.directory)->required();
  auto* timing = app.add_subcommand("time", "step a bed and print one line of JSON");
  timing->add_option("DIR", options.directory, "as left by export or sink")->required();
  timing->add_option("--steps", options.steps, "timed")->required();
  timing->add_option("--warm-up", options.warm_up, "steps before");
  timing->add_flag("--rolling", options.rolls, "with elastic-plastic rolling resistance");
  timing->add_option("--uneven", options.uneven,
                     "slowest over mean rank from which space is cut anew; inf: never");
  timing->add_option("--threads", options.threads, "of each rank")->check(CLI::Range(1, 1024));
  timing->add_option("--state", options.state, "file for the grains at the end");
  auto* measuring = app.add_subcommand("measure", "energy, contacts and overlap of a state");
  measuring->add_option("DIR", options.directory)->required();
  measuring->add_option("STATE", options.state, "rows: id, x, v, spin")->required();
  GiantOptions giant{.time_step = kTimeStep, .skin = kSkin};
  auto* making = app.add_subcommand("giant", "step, store and restart many copies of a bed");
  making->add_option("DIR", giant.directory, "as left by export")->required();
  making->add_option("ROOM", giant.room, "directory for the checkpoint")->required();
  making->add_option("--tiles-x", giant.tiles_x, "copies along x");
  making->add_option("--tiles-y", giant.tiles_y, "copies along y");
  making->add_option("--steps", giant.steps, "before and after the checkpoint")->required();
  making->add_flag("--rolling", giant.rolls, "with elastic-plastic rolling resistance");
  CLI11_PARSE(app, argc, argv);
  if (exporting->parsed()) export_bed(ranks, options.directory);
  if (sinking->parsed()) sink_wheel(ranks, other, options.directory);
  if (timing->parsed()) time_steps(ranks, options);
  if (making->parsed()) {
    const Case input = read_bench_case(giant.directory);
    run_giant(ranks, input, read_bed(giant.directory / "bed.txt", input.grains.density), giant);
  }
  if (measuring->parsed()) measure(options.directory, options.state);
  return 0;
}

}  // namespace
}  // namespace grouser::bench

int main(int argc, char** argv) {
  const grouser::ParallelSession session(&argc, &argv);
  const grouser::Communicator ranks;
  grouser::set_up_log(ranks.rank());
  try {
    return grouser::bench::run(argc, argv, ranks);
  } catch (const std::exception& error) {
    std::cerr << "dem_bench: " << error.what() << '\n';
    grouser::abort_all_ranks(1);
  }
}
