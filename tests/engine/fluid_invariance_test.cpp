// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/engine/fluid_world.hpp"

namespace grouser {
namespace {

// Run under mpirun with any number of ranks; the first also runs the same on its own to compare.

Case flow(double amplitude) {
  Case input = fluid_case(1000.0, 0.05, 0.1);
  FluidCase& f = input.fluid;
  f.velocity_x = 0.3;
  f.shear_rate = 4.0;
  f.drag.amplitude = f.buoyancy.amplitude = f.added_mass.amplitude = f.history.amplitude =
      f.shear_lift.amplitude = f.spin_lift.amplitude = f.spin_drag.amplitude =
          f.lubrication.amplitude = amplitude;
  f.history.law = "mei_adrian";
  f.drag.law = "di_felice";
  f.void_fraction = 0.8;
  if (amplitude > 0.0) input.probes.push_back({7, "x", "gap", 0.0, 0.05, 0.1, 1e-3});
  return input;
}

// Grains that settle while the flow carries them through the columns of all ranks.
class Sediment {
 public:
  Sediment(const Communicator& ranks, const Case* input, int threads = 1)
      : world_(ranks, settings(threads)) {
    add_box(world_, {0.5, 0.4, 0.05});
    if (input != nullptr) outer_ = std::make_unique<OuterForces>(*input, world_);
  }

  void fill(int count = 81) {
    const std::vector<Particle> grains = loose_column(count, 3);
    for (const Particle& grain : grains)
      if (world_.owns(grain.position)) world_.add_particle(grain);
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      if (outer_) outer_->announce(0, 0.0, false);
      ASSERT_EQ(world_.step().fault, Fault::kNone);
    }
  }
  State state() const {
    State state;
    world_.save_state(state);
    if (outer_) outer_->save_state(state);
    return state;
  }
  std::uint64_t hash() const { return hash_state(world_.ranks(), state()); }
  void load(const State& state) {
    world_.load_state(state);
    if (outer_) outer_->load_state(state);
  }

 private:
  static WorldSettings settings(int threads) {
    WorldSettings settings = small_settings();
    settings.threads = threads;
    settings.time_step = 2e-5;
    return settings;
  }

  World world_;
  std::unique_ptr<OuterForces> outer_;
};

TEST(FluidInvariance, TrajectoryIsTheSameBitForBitOnAnyNumberOfRanks) {
  const Case input = flow(1.0);
  Sediment together(Communicator(), &input);
  Sediment alone(Communicator::alone(), &input);
  together.fill();
  alone.fill();
  for (int leg = 0; leg < 2; ++leg) {
    together.run(800);
    if (Communicator().rank() == 0) alone.run(800);
    const auto expected = static_cast<std::uint64_t>(
        Communicator().from_first(static_cast<std::int64_t>(alone.hash())));
    ASSERT_EQ(together.hash(), expected) << "after leg " << leg;
  }
}

TEST(FluidInvariance, TrajectoryIsTheSameBitForBitOnAnyNumberOfThreads) {
  const Case input = flow(1.0);
  Sediment one(Communicator(), &input, 1);
  Sediment three(Communicator(), &input, 3);
  for (Sediment* sediment : {&one, &three}) {
    sediment->fill(600);  // so many that every thread has some
    sediment->run(60);
  }
  EXPECT_EQ(three.hash(), one.hash());
}

TEST(FluidInvariance, HistoriesSurviveARestartBitForBit) {
  const Case input = flow(1.0);
  Sediment straight(Communicator(), &input);
  straight.fill();
  straight.run(300);
  const State state = straight.state();
  Sediment resumed(Communicator(), &input);
  resumed.load(state);
  EXPECT_EQ(resumed.hash(), straight.hash());
  straight.run(300);
  resumed.run(300);
  EXPECT_EQ(resumed.hash(), straight.hash());
}

TEST(FluidInvariance, AmplitudesOfZeroLeaveEveryBitAlone) {
  const Case input = flow(0.0);
  Sediment dry(Communicator(), nullptr);
  Sediment off(Communicator(), &input);
  dry.fill();
  off.fill();
  dry.run(500);
  off.run(500);
  EXPECT_EQ(off.hash(), dry.hash());
}

}  // namespace
}  // namespace grouser
