// SPDX-License-Identifier: BSD-3-Clause
// One point of a scaling curve on simulated ranks; see docs/performance/scaling.md. Built by
// smpicxx and started by bench/scaling/run.py:
//   scaling_driver steps STEP LISTS CORES OVERLAP PART
//     STEP     seconds of a core for a particle-step
//     LISTS    seconds of a core for the new lists of a grain or ghost
//     CORES    of each rank, among which its particle-steps and lists are divided evenly
//     OVERLAP  1 when pairs without ghosts are evaluated while ghosts are under way, else 0
//     PART     a PARTth of the bed along x
//   scaling_driver packing   real times of a halo's renewal and making; on two ranks
#include <algorithm>
#include <chrono>
#include <cmath>
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
constexpr double kPackingSeconds = 15e-9;  // per ghost and step; see `packing`
constexpr double kHaloSeconds = 830e-9;    // per ghost and rebuild; see `packing`
constexpr int kSteps = 2;                  // timed; in the simulation all steps are alike
constexpr std::size_t kBodies = 2;         // box and wheel
// A grain that migrates: record, origin, five pairs with seven numbers of history, counts.
constexpr std::size_t kMigrantBytes = 96 + 24 + 8 + 5 * (8 + 7 * 8) + kBodies * 8;

struct Costs {
  double step;
  double lists;
  int cores;
  bool overlaps;
  int part;
};

struct Phases {
  double compute = 0.0;
  double halo = 0.0;
  double agree = 0.0;
  double exchange = 0.0;
  double rebuild = 0.0;
};

double now() { return simgrid::s4u::Engine::get_clock(); }

// Lets simulated time pass on this rank's core of 1 Gflop/s.
void compute(double seconds) { simgrid::s4u::this_actor::execute(seconds * 1e9); }

// Grains that pairs with ghosts count for on top of a rank's own. A pair between two boxes is
// evaluated on both sides: each does half of it more than its share. An area of a cut crosses as
// many pairs as have their centres on both sides: density of pairs times half their length, which
// is the mean along an axis. Pairs are as many as grains: the share of a step is a grain's.
double done_twice(const ScalingBed& bed, const Box& box) {
  const auto side = [](double low, double high, double end) {
    return std::min(high, end) - std::max(low, 0.0);
  };
  const double x = side(box.low.x, box.high.x, bed.high.x);
  const double y = side(box.low.y, box.high.y, bed.high.y);
  const double z = side(box.low.z, box.high.z, bed.high.z);
  const auto inner_faces = [](double low, double high) {
    return (std::isfinite(low) ? 1.0 : 0.0) + (std::isfinite(high) ? 1.0 : 0.0);
  };
  const double cut = inner_faces(box.low.x, box.high.x) * y * z +
                     inner_faces(box.low.y, box.high.y) * x * z +
                     inner_faces(box.low.z, box.high.z) * x * y;
  const double density = bed.grains() / (bed.high.x * bed.high.y * bed.high.z);
  return 0.5 * density * cut * 0.5 * bed.contact_length;
}

// One rank of the engine, as World has it.
struct Rank {
  explicit Rank(const Communicator& all, int part = 1)
      : ranks(all),
        bed(ScalingBed{}.part(part)),
        boxes(Decomposition::even({}, bed.high, all.size())),
        neighbours(boxes.neighbours(all.rank(), bed.reach())),
        share(bed_share(bed, boxes, all.rank())),
        owned(share.grains.size()),
        halo(all) {}

  double ghosts() const { return static_cast<double>(share.grains.size() - owned); }

  // As World::rebuild does: migration, count, halo. Grains stay where they are here: as many come
  // as go.
  void rebuild(Phases& time) {
    double from = now();
    std::vector<Bytes> out(neighbours.size());
    std::vector<Particle> moved = share.grains;
    stir(0.5 * bed.skin, moved);
    for (const Particle& grain : moved) {
      const int owner = boxes.owner_of(grain.position);
      const auto at = std::find(neighbours.begin(), neighbours.end(), owner);
      if (at == neighbours.end()) continue;
      Bytes& to = out[static_cast<std::size_t>(at - neighbours.begin())];
      to.resize(to.size() + kMigrantBytes);
    }
    ranks.exchange_with(neighbours, out);
    time.exchange = now() - from;
    from = now();
    ranks.max(bed.skin);
    ranks.sum(static_cast<std::int64_t>(owned));
    halo.build(ranks, boxes, neighbours, bed.largest_radius, bed.skin, share.grains);
    time.rebuild = now() - from;
  }

  Communicator ranks;
  ScalingBed bed;
  Decomposition boxes;
  std::vector<int> neighbours;
  BedShare share;
  std::size_t owned;
  Halo halo;
};

double mean(const Communicator& ranks, double value) {
  return 1e-12 * static_cast<double>(ranks.sum(static_cast<std::int64_t>(value * 1e12))) /
         ranks.size();
}

void run_steps(const Communicator& ranks, const Costs& costs) {
  Rank rank(ranks, costs.part);
  ranks.barrier();
  Phases time;
  rank.rebuild(time);
  const double count = static_cast<double>(rank.share.count);
  const double ghosts = rank.ghosts();
  const double twice = kPairShare * done_twice(rank.bed, rank.boxes.box(ranks.rank()));
  const double outer = costs.overlaps ? static_cast<double>(rank.share.outer) : count;
  const double core = costs.step / costs.cores;
  time.rebuild += costs.lists / costs.cores * (count + ghosts) + kHaloSeconds * ghosts;
  ranks.barrier();
  const double from = now();
  for (int s = 0; s < kSteps; ++s) {
    double at = now();
    const auto spent = [&at] {
      const double since = now() - at;
      at = now();
      return since / kSteps;
    };
    compute(kPackingSeconds * ghosts);
    rank.halo.start(rank.share.grains);
    time.halo += spent();
    compute(core * (count - outer));
    time.compute += spent();
    rank.halo.finish();
    time.halo += spent();
    compute(core * (outer + twice));
    time.compute += spent();
    Communicator::StepTotals totals;
    totals.sums.resize(5 * kBodies + 3);
    totals.maxima.resize(6);
    ranks.combine(totals);
    time.agree += spent();
  }
  const double step = ranks.max(now() - from) / kSteps;
  const double most = ranks.max(count);
  const double all = 1.0 * static_cast<double>(ranks.sum(rank.share.count));
  const double exchange = ranks.max(time.exchange);
  const double rebuild = ranks.max(time.rebuild);
  const double ghosts_mean = mean(ranks, 1e-3 * ghosts) * 1e3;
  const double twice_mean = mean(ranks, core * twice);
  const double outer_mean = mean(ranks, 1e-3 * outer) * 1e3;
  const double neighbours = mean(ranks, static_cast<double>(rank.neighbours.size()));
  const double halo = mean(ranks, time.halo);
  const double computing = mean(ranks, time.compute);
  const double agree = mean(ranks, time.agree);
  if (ranks.rank() != 0) return;
  std::printf(
      "{\"ranks\": %d, \"cores\": %d, \"grains\": %.0f, \"most\": %.0f, \"ghosts\": %.0f, "
      "\"neighbours\": %.2f, \"outer\": %.0f, \"step_cost\": %g, \"lists_cost\": %g, \"step\": "
      "%.9f, "
      "\"compute\": %.9f, \"twice\": %.9f, \"packing\": %.9f, \"halo\": %.9f, \"agree\": %.9f, "
      "\"rebuild\": %.9f, \"exchange\": %.9f}\n",
      ranks.size(), costs.cores, all, most, ghosts_mean, neighbours, outer_mean, costs.step,
      costs.lists, step, computing, twice_mean, kPackingSeconds * ghosts_mean, halo, agree, rebuild,
      exchange);
  std::fflush(stdout);
}

// Both ranks share one process and core, so the real time of both, less than 0.1 ms of which is the
// simulator's, is that of packing, copying and making all ghosts.
void measure_packing(const Communicator& ranks) {
  Rank rank(ranks);
  // Plates side by side, so large that what the simulator itself takes for a message is little.
  rank.bed.high = {0.0698, 0.3490, 0.3490};
  rank.bed.count_x = 46;
  rank.bed.count_y = 230;
  rank.bed.count_z = 230;
  rank.boxes = Decomposition::even({}, rank.bed.high, ranks.size());
  rank.share = bed_share(rank.bed, rank.boxes, ranks.rank());
  rank.owned = rank.share.grains.size();
  const auto timed = [&](int times, const auto& work) {
    ranks.barrier();
    const auto from = std::chrono::steady_clock::now();
    for (int i = 0; i < times; ++i) work();
    ranks.barrier();
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - from;
    return spent.count() / times;
  };
  const double making = timed(20, [&] {
    rank.share.grains.resize(rank.owned);
    rank.halo.build(ranks, rank.boxes, rank.neighbours, rank.bed.largest_radius, rank.bed.skin,
                    rank.share.grains);
  });
  const double renewing = timed(300, [&] {
    rank.halo.start(rank.share.grains);
    rank.halo.finish();
  });
  const double ghosts = static_cast<double>(ranks.sum(static_cast<std::int64_t>(rank.ghosts())));
  if (ranks.rank() == 0)
    std::printf("{\"ghosts\": %.0f, \"making_s\": %.3g, \"renewing_s\": %.3g}\n", ghosts,
                making / ghosts, renewing / ghosts);
  std::fflush(stdout);
}

}  // namespace
}  // namespace grouser::bench

int main(int argc, char** argv) {
  const grouser::ParallelSession session(&argc, &argv);
  const grouser::Communicator ranks;
  if (argc == 2 && std::strcmp(argv[1], "packing") == 0) {
    grouser::bench::measure_packing(ranks);
  } else if (argc == 7 && std::strcmp(argv[1], "steps") == 0) {
    grouser::bench::run_steps(ranks, {std::atof(argv[2]), std::atof(argv[3]), std::atoi(argv[4]),
                                      std::atoi(argv[5]) != 0, std::atoi(argv[6])});
  } else {
    std::fputs("scaling_driver: steps STEP LISTS CORES OVERLAP PART, or packing\n", stderr);
    return 2;
  }
  return 0;
}
