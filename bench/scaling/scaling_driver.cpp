// SPDX-License-Identifier: BSD-3-Clause
// One strong-scaling point on simulated ranks; see docs/performance/scaling.md. Built by smpicxx
// and started by bench/scaling/run.py:
//   scaling_driver steps RATE EXCHANGE LAYERS CORES
//     RATE      particle-steps per second and core
//     EXCHANGE  1 with the migration of grains, 0 without
//     LAYERS    of grains on top of each other that are there; each stands for 131 / LAYERS, and
//               the network must be slower by that much
//     CORES     of each rank, among which all its work is divided evenly
//   scaling_driver packing   real time of a halo update; on two ranks
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <simgrid/s4u.hpp>

#include "bench/scaling/bed_share.hpp"
#include "engine/core/halo.hpp"

namespace grouser::bench {
namespace {

// Share of a particle-step that belongs to its pairs, and so is done twice for pairs between ranks:
// contacts against sums and motion in docs/performance/log.md.
constexpr double kPairShare = 0.6;
constexpr double kPackingSeconds = 25e-9;   // per ghost and step; see `packing`
constexpr double kRebuildSeconds = 400e-9;  // per grain or ghost: about 1 000 cycles
constexpr int kSteps = 2;                   // timed; in the simulation all steps are alike
constexpr std::size_t kBodies = 2;          // box and wheel
// A grain that migrates: record, origin, five pairs with seven numbers of history, counts.
constexpr std::size_t kMigrantBytes = 96 + 24 + 8 + 5 * (8 + 7 * 8) + kBodies * 8;

double now() { return simgrid::s4u::Engine::get_clock(); }

// Lets simulated time pass on this rank's core of 1 Gflop/s.
void compute(double seconds) { simgrid::s4u::this_actor::execute(seconds * 1e9); }

struct Phases {
  double compute = 0.0;
  double halo = 0.0;
  double agree = 0.0;
  double exchange = 0.0;
  double rebuild = 0.0;
};

// Time of one rank's particle-steps. A pair between two columns is evaluated on both sides: each
// does half of it more than its share. An area of a cut crosses as many pairs as have their
// centres on both sides: density of pairs times half their length, which is the mean along x.
double step_seconds(const ScalingBed& bed, const Decomposition& columns, std::size_t owned,
                    double rate) {
  const double dx = columns.high_x() - columns.low_x();
  const double dy = columns.high_y() - columns.low_y();
  double cut = 0.0;
  for (const int side : {-1, 1}) {
    if (columns.neighbour(side, 0) >= 0) cut += dy * bed.high.z;
    if (columns.neighbour(0, side) >= 0) cut += dx * bed.high.z;
  }
  const double density = bed.grains() / (bed.high.x * bed.high.y * bed.high.z);
  const double twice = 0.5 * density * cut * 0.5 * bed.contact_length;
  return (static_cast<double>(owned) + kPairShare * twice) / rate;
}

// As World::rebuild does: migration, count, halo. Leaves the ghosts in place.
void rebuild(const Communicator& ranks, const Decomposition& columns, const ScalingBed& bed,
             bool exchanges, std::vector<Particle>& grains, Halo& halo, Phases& time) {
  double from = now();
  if (exchanges) {
    std::vector<Bytes> out(static_cast<std::size_t>(ranks.size()));
    for (const Particle& grain : grains) {
      const int owner = columns.owner_of(grain.position);
      if (owner == ranks.rank()) continue;
      Bytes& to = out[static_cast<std::size_t>(owner)];
      to.resize(to.size() + kMigrantBytes);
    }
    ranks.exchange_all(out);
  }
  time.exchange = now() - from;
  from = now();
  // Grains stay where they are here: as many come as go.
  ranks.max(bed.skin);
  ranks.sum(static_cast<std::int64_t>(grains.size()));
  halo.build(ranks, columns, bed.reach(), grains);
  time.rebuild = now() - from;
}

double mean(const Communicator& ranks, double seconds) {
  return 1e-12 * static_cast<double>(ranks.sum(static_cast<std::int64_t>(seconds * 1e12))) /
         ranks.size();
}

void run_steps(const Communicator& ranks, double rate, bool exchanges, int layers, int cores) {
  ScalingBed bed;
  const double grains_for_one = static_cast<double>(bed.count_z) / layers;
  const double stands_for = grains_for_one / cores;
  bed.high.z /= grains_for_one;
  bed.count_z = layers;
  const Decomposition columns(Vec3{}, bed.high, ranks.size(), ranks.rank(), bed.reach());
  std::vector<Particle> grains = bed_share(bed, columns, ranks.rank());
  const std::size_t owned = grains.size();
  stir(0.5 * bed.skin, grains);
  ranks.barrier();

  Phases time;
  Halo halo;
  rebuild(ranks, columns, bed, exchanges, grains, halo, time);
  const double making_lists = stands_for * kRebuildSeconds * static_cast<double>(grains.size());
  const auto ghosts = static_cast<std::int64_t>(grains.size() - owned);
  const double own_seconds = stands_for * step_seconds(bed, columns, owned, rate);
  ranks.barrier();
  const double from = now();
  for (int s = 0; s < kSteps; ++s) {
    double at = now();
    compute(stands_for * kPackingSeconds * static_cast<double>(ghosts));
    halo.update(ranks, grains);
    time.halo += (now() - at) / kSteps;
    at = now();
    compute(own_seconds);
    time.compute += (now() - at) / kSteps;
    at = now();
    Communicator::StepTotals totals;
    totals.sums.resize(5 * kBodies + 1);
    totals.maxima.resize(5);
    ranks.combine(totals);
    time.agree += (now() - at) / kSteps;
  }
  const double step = ranks.max(now() - from) / kSteps;
  const std::int64_t all = ranks.sum(static_cast<std::int64_t>(owned));
  const std::int64_t most = ranks.max(static_cast<std::int64_t>(owned));
  const std::int64_t all_ghosts = ranks.sum(ghosts);
  const double exchange = ranks.max(time.exchange);
  const double building = ranks.max(time.rebuild + making_lists);
  const double halo_mean = mean(ranks, time.halo);
  const double compute_mean = mean(ranks, time.compute);
  const double agree_mean = mean(ranks, time.agree);
  if (ranks.rank() != 0) return;
  std::printf(
      "{\"ranks\": %d, \"columns\": [%d, %d], \"grains\": %.0f, \"most\": %.0f, \"ghosts\": %.0f, "
      "\"rate\": %g, \"step\": %.9f, \"compute\": %.9f, \"halo\": %.9f, \"agree\": %.9f, "
      "\"rebuild\": %.9f, \"exchange\": %.9f}\n",
      ranks.size(), columns.columns_x(), columns.columns_y(),
      grains_for_one * static_cast<double>(all), grains_for_one * static_cast<double>(most),
      grains_for_one * static_cast<double>(all_ghosts), rate, step, compute_mean, halo_mean,
      agree_mean, building, exchanges ? exchange : -1.0);
  std::fflush(stdout);
}

// Both ranks share one process and core, so the real time of an update, less than 0.1 ms of which
// is the simulator's, is that of packing, copying and unpacking all ghosts.
void measure_packing(const Communicator& ranks) {
  ScalingBed bed;
  bed.high = {1.2192 / 48, 0.5334 / 32, 0.2006};  // a column at 3 072 ranks, twice
  bed.count_x = 16;
  bed.count_y = 11;
  const Decomposition columns(Vec3{}, bed.high, ranks.size(), ranks.rank(), bed.reach());
  std::vector<Particle> grains = bed_share(bed, columns, ranks.rank());
  const std::size_t owned = grains.size();
  Halo halo;
  halo.build(ranks, columns, bed.reach(), grains);
  const std::int64_t ghosts = ranks.sum(static_cast<std::int64_t>(grains.size() - owned));
  ranks.barrier();
  constexpr int kTimes = 300;
  const auto from = std::chrono::steady_clock::now();
  for (int i = 0; i < kTimes; ++i) halo.update(ranks, grains);
  ranks.barrier();
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - from;
  if (ranks.rank() == 0)
    std::printf("{\"ghosts\": %lld, \"seconds_per_ghost\": %.3g}\n", static_cast<long long>(ghosts),
                spent.count() / kTimes / static_cast<double>(ghosts));
  std::fflush(stdout);
}

}  // namespace
}  // namespace grouser::bench

int main(int argc, char** argv) {
  const grouser::ParallelSession session(&argc, &argv);
  const grouser::Communicator ranks;
  if (argc == 2 && std::strcmp(argv[1], "packing") == 0) {
    grouser::bench::measure_packing(ranks);
  } else if (argc == 6 && std::strcmp(argv[1], "steps") == 0) {
    grouser::bench::run_steps(ranks, std::atof(argv[2]), std::atoi(argv[3]) != 0,
                              std::atoi(argv[4]), std::atoi(argv[5]));
  } else {
    std::fputs("scaling_driver: steps RATE EXCHANGE LAYERS CORES, or packing\n", stderr);
    return 2;
  }
  return 0;
}
