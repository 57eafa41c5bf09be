// SPDX-License-Identifier: BSD-3-Clause
// One run of a suspension of moving spheres in a periodic cube and, in turn, of plain flow in the
// same; prints one line of JSON. Started by coupled.py.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "bench/lbm/timed.hpp"
#include "engine/lbm/flow.hpp"

namespace grouser::bench {
namespace {

struct Options {
  std::string precision = "double";
  std::int64_t cells = 128;
  std::int64_t spheres = 5;  // along each axis
  double solids = 0.33;
  int steps = 10;
};

double middle(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Spheres on a grid that goes on as one, each turning about another axis.
class Suspension {
 public:
  explicit Suspension(const Options& options) : side_(static_cast<double>(options.cells)) {
    const double pitch = side_ / static_cast<double>(options.spheres);
    radius_ = pitch * std::cbrt(options.solids * 3.0 / (4.0 * std::numbers::pi));
    for (std::int64_t k = 0; k < options.spheres * options.spheres * options.spheres; ++k) {
      const auto at = [&](std::int64_t number) {
        return pitch * (static_cast<double>(number % options.spheres) + 0.37);
      };
      const auto turn = static_cast<double>(k);
      balls_.push_back({{at(k), at(k / options.spheres), at(k / options.spheres / options.spheres)},
                        radius_,
                        {0.011, 0.007, -0.005},
                        {1e-3 * std::sin(turn), 1e-3 * std::cos(turn), 5e-4}});
    }
  }

  double diameter() const { return 2.0 * radius_; }

  // Those that cover cells of a rank's block; the next call has them one step further.
  const std::vector<ImmersedBall>& next(const CellBlocks& blocks, int rank) {
    mine_.clear();
    for (ImmersedBall& ball : balls_) {
      for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z})
        ball.centre.*axis = std::fmod(ball.centre.*axis + ball.velocity.*axis + side_, side_);
      const std::vector<int> owners = blocks.owners_within(ball.centre, ball.radius + 1.0);
      if (std::find(owners.begin(), owners.end(), rank) != owners.end()) mine_.push_back(ball);
    }
    return mine_;
  }

 private:
  double side_;
  double radius_ = 0.0;
  std::vector<ImmersedBall> balls_;
  std::vector<ImmersedBall> mine_;
};

nlohmann::json run(const Communicator& ranks, const Options& options) {
  FlowSettings settings;
  settings.precision = options.precision == "float" ? Precision::kSingle : Precision::kDouble;
  settings.parameters.viscosity_lu = 0.05;
  settings.cells = {options.cells, options.cells, options.cells};
  const auto flow = make_flow(ranks, settings);
  Suspension suspension(options);
  std::vector<double> plain;
  std::vector<double> coupled;
  double pushed = 0.0;
  constexpr int kTurns = 5;
  for (int turn = -1; turn < kTurns; ++turn) {  // one before they count
    flow->immerse({});
    const double without = timed(ranks, [&] {
      for (int k = 0; k < options.steps; ++k) flow->step();
    });
    const double with = timed(ranks, [&] {
      for (int k = 0; k < options.steps; ++k) {
        flow->immerse(suspension.next(flow->blocks(), ranks.rank()));
        flow->step();
        for (const ImmersedLoad& load : flow->immersed_loads()) pushed += norm(load.force_lu());
      }
    });
    if (turn < 0) continue;
    plain.push_back(without);
    coupled.push_back(with);
  }
  const double cells = std::pow(static_cast<double>(options.cells), 3);
  const auto mlups = [&](const std::vector<double>& seconds) {
    return 1e-6 * cells * options.steps / middle(seconds);
  };
  std::vector<double> shares;
  for (std::size_t turn = 0; turn < plain.size(); ++turn)
    shares.push_back(plain[turn] / coupled[turn]);
  return {{"plain_mlups", mlups(plain)},
          {"coupled_mlups", mlups(coupled)},
          {"fraction_of_plain", middle(shares)},
          {"diameter", suspension.diameter()},
          {"bytes_per_cell",
           static_cast<double>(ranks.sum(static_cast<std::int64_t>(flow->bytes()))) / cells},
          {"finite", flow->totals().finite && std::isfinite(pushed) && pushed > 0.0}};
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("times a suspension on a lattice");
  app.add_option("--precision", options.precision)->check(CLI::IsMember({"double", "float"}));
  app.add_option("--cells", options.cells, "along each axis")->check(CLI::Range(16, 1024));
  app.add_option("--spheres", options.spheres, "along each axis")->check(CLI::Range(1, 64));
  app.add_option("--solids", options.solids, "fraction")->check(CLI::Range(0.01, 0.5));
  app.add_option("--steps", options.steps)->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  const Communicator ranks;
  const nlohmann::json result = run(ranks, options);
  if (ranks.rank() == 0) std::cout << result.dump() << std::endl;
  return 0;
}

}  // namespace
}  // namespace grouser::bench

int main(int argc, char** argv) {
  const grouser::ParallelSession session(&argc, &argv);
  return grouser::bench::main_of(argc, argv);
}
