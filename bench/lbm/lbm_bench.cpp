// SPDX-License-Identifier: BSD-3-Clause
// One run of plain flow in a periodic cube and, around it, of the bandwidth that its streams of
// memory could have; prints one line of JSON. Started by compare.py.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/lbm/timed.hpp"
#include "engine/lbm/flow.hpp"
#include "engine/lbm/lattice.hpp"
#include "engine/lbm/populations.hpp"
#include "engine/lbm/sweep.hpp"

namespace grouser::bench {
namespace {

struct Options {
  std::string lattice = "D3Q19";
  std::string precision = "double";
  std::string collision = "trt";
  std::int64_t cells = 128;
  int steps = 20;
};

// Every number read, changed a little and written back where it was, kStreams arrays side by side.
template <class Real, std::size_t kStreams, bool kFetch>
void update(Populations<Real>& populations, std::ptrdiff_t length) {
  constexpr auto kLanes = static_cast<std::ptrdiff_t>(WideOf<Real>::kLanes);
  Real* streams[kStreams];
  for (std::size_t i = 0; i < kStreams; ++i) streams[i] = populations.of(i);
  for (std::ptrdiff_t at = 0; at < length; at += kLanes)
    unroll<kStreams>([&](auto i) GROUSER_INLINE {
      Real* const here = streams[i] + at;
      if (kFetch) __builtin_prefetch(reinterpret_cast<const char*>(here) + kFetchAhead);
      store_wide(here, load_wide(here) * Real(0.999));
    });
}

// Bytes per second that all ranks read and write together.
struct Bandwidth {
  double streams = 0.0;  // as many as the lattice has velocities; with or without fetching ahead
  double one = 0.0;      // one after the other
};

template <class Set, class Real>
class Streams {
 public:
  explicit Streams(const CellBox& box) : populations_(box, Set::kVelocities) {}

  Bandwidth measure(const Communicator& ranks) {
    constexpr auto kLanes = static_cast<std::ptrdiff_t>(WideOf<Real>::kLanes);
    const std::ptrdiff_t length = populations_.box().cells() / kLanes * kLanes;
    constexpr auto kVelocities = static_cast<std::ptrdiff_t>(Set::kVelocities);
    const auto bytes = [&](std::ptrdiff_t numbers) {
      return 2.0 * static_cast<double>(sizeof(Real)) * static_cast<double>(numbers) *
             static_cast<double>(ranks.size());
    };
    const double fetched =
        timed(ranks, [&] { update<Real, Set::kVelocities, true>(populations_, length); });
    const double plain =
        timed(ranks, [&] { update<Real, Set::kVelocities, false>(populations_, length); });
    const std::ptrdiff_t all = (kVelocities - 1) * populations_.step_velocity() / kLanes * kLanes;
    const double one = timed(ranks, [&] { update<Real, 1, false>(populations_, all); });
    return {bytes(length * kVelocities) / std::min(fetched, plain), bytes(all) / one};
  }

 private:
  Populations<Real> populations_;
};

double middle(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

template <class Set, class Real>
nlohmann::json run(const Communicator& ranks, const Options& options) {
  FlowSettings settings;
  settings.lattice = options.lattice;
  settings.collision = options.collision;
  settings.precision = sizeof(Real) == 4 ? Precision::kSingle : Precision::kDouble;
  settings.parameters.viscosity_lu = 0.02;
  settings.parameters.smagorinsky = 0.15;
  settings.cells = {options.cells, options.cells, Set::kDimensions == 3 ? options.cells : 1};
  const auto flow = make_flow(ranks, settings);
  flow->set_equilibrium([&](const Vec3& p) {
    return FlowNode{1.0, {0.02 * std::sin(0.1 * p.y), 0.01 * std::cos(0.1 * p.x), 0.0}};
  });
  const CellBlocks& blocks = flow->blocks();
  Streams<Set, Real> streams(
      CellBox{blocks.count(0), blocks.count(1), blocks.count(2), Set::kDimensions == 3 ? 1 : 0});
  streams.measure(ranks);  // pages are there from now on
  flow->step();
  flow->step();
  std::vector<double> side_by_side;
  std::vector<double> one;
  std::vector<double> seconds;
  constexpr int kTurns = 5;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Bandwidth bandwidth = streams.measure(ranks);
    side_by_side.push_back(bandwidth.streams);
    one.push_back(bandwidth.one);
    seconds.push_back(timed(ranks, [&] {
      for (int k = 0; k < options.steps; ++k) flow->step();
    }));
  }
  const double cells = static_cast<double>(settings.cells[0] * settings.cells[1]) *
                       static_cast<double>(settings.cells[2]);
  const double mlups = 1e-6 * cells * options.steps / middle(seconds);
  const double per_cell = 2.0 * static_cast<double>(Set::kVelocities * sizeof(Real));
  const FlowTotals totals = flow->totals();
  return {{"mlups", mlups},
          {"limit_mlups", 1e-6 * middle(side_by_side) / per_cell},
          {"streams_gb_per_s", 1e-9 * middle(side_by_side)},
          {"one_stream_gb_per_s", 1e-9 * middle(one)},
          {"bytes_per_cell",
           static_cast<double>(ranks.sum(static_cast<std::int64_t>(flow->bytes()))) / cells},
          {"momentum", totals.max_speed_lu},
          {"finite", totals.finite}};
}

template <class Set>
nlohmann::json run(const Communicator& ranks, const Options& options) {
  return options.precision == "float" ? run<Set, float>(ranks, options)
                                      : run<Set, double>(ranks, options);
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("times plain flow on a lattice");
  app.add_option("--lattice", options.lattice)
      ->check(CLI::IsMember({"D2Q9", "D3Q15", "D3Q19", "D3Q27"}));
  app.add_option("--precision", options.precision)->check(CLI::IsMember({"double", "float"}));
  app.add_option("--collision", options.collision);
  app.add_option("--cells", options.cells, "along each axis")->check(CLI::Range(8, 1024));
  app.add_option("--steps", options.steps)->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  const Communicator ranks;
  nlohmann::json result;
  if (options.lattice == "D2Q9") result = run<D2Q9>(ranks, options);
  if (options.lattice == "D3Q15") result = run<D3Q15>(ranks, options);
  if (options.lattice == "D3Q19") result = run<D3Q19>(ranks, options);
  if (options.lattice == "D3Q27") result = run<D3Q27>(ranks, options);
  if (ranks.rank() == 0) std::cout << result.dump() << std::endl;
  return 0;
}

}  // namespace
}  // namespace grouser::bench

int main(int argc, char** argv) {
  const grouser::ParallelSession session(&argc, &argv);
  return grouser::bench::main_of(argc, argv);
}
