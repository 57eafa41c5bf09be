// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/terrain/wheel.hpp"
#include "tests/engine/drum_world.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {
namespace {

// Run under mpirun with any number of ranks. Enough grains that several threads of several ranks
// have chunks of them, and share borders that grains cross.
constexpr int kGrains = 2500;
constexpr int kSteps = 1600;

Particle grain(int i, std::uint64_t seed) {
  const auto item = static_cast<std::uint64_t>(i);
  const auto draw = [&](std::uint64_t stream) { return random_unit(seed, item, stream); };
  const double pitch = 0.1 / 24.0;
  const double radius = 1e-3 + 1e-3 * draw(0);
  const double free = pitch - 2.0 * radius;
  const auto at = [&](int slot, std::uint64_t stream) {
    return slot * pitch + radius + free * draw(stream);
  };
  Particle p = sphere(i, radius, {at(i % 24, 1), at(i / 24 % 24, 2), at(i / 576, 3)});
  p.position.z += i / 576 < 2 ? 0.0 : 0.03;
  p.velocity = {draw(4) - 0.5, draw(5) - 0.5, i / 576 < 2 ? -0.2 : -2.0};
  return p;
}

// Grains that rain on others and on a drum that is driven by what they do to it.
World rain(const Communicator& ranks, int threads, double skin, std::uint64_t seed,
           double uneven = 1.05) {
  WorldSettings settings = rolling_settings(skin);
  settings.largest_radius = 2e-3;
  settings.threads = threads;
  settings.uneven = uneven;
  World world(ranks, settings);
  add_box_and_drum(world, 0.03, {0.05, 0.05, 0.026}).spin = 20.0;
  add_share(world, kGrains, [&](std::size_t i) { return grain(static_cast<int>(i), seed); });
  return world;
}

void run(World& world, int steps) {
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(world.step().fault, Fault::kNone);
    drive_drum(world);
  }
}

// The hash of one rank with one thread, told to all.
std::uint64_t alone_after(int steps, std::uint64_t seed) {
  World alone = rain(Communicator::alone(), 1, 0.5e-3, seed);
  if (Communicator().rank() == 0) {
    run(alone, steps);
    EXPECT_GT(alone.contacts(), 300);
    EXPECT_NE(alone.body(1).motion.spin, 20.0);
  }
  return static_cast<std::uint64_t>(
      Communicator().from_first(static_cast<std::int64_t>(hash_of(alone))));
}

TEST(Threads, TrajectoryIsTheSameBitForBitOnAnyNumberOfThreadsAndRanks) {
  const std::uint64_t expected = alone_after(kSteps, 21);
  // Many threads of many ranks show no more and take long.
  const int most = Communicator().size() > 2 ? 2 : 4;
  for (int threads = 1; threads <= most; ++threads) {
    // Another skin each time: lists are made, and shares cut, at other steps.
    World world = rain(Communicator(), threads, 0.3e-3 + 0.1e-3 * threads, 21);
    run(world, kSteps);
    ASSERT_EQ(hash_of(world), expected) << threads << " threads";
    EXPECT_GT(world.kinetic_energy(), 0.0);
  }
}

TEST(Threads, CutsBetweenRanksAndChunksInTheMiddleChangeNoBit) {
  const std::uint64_t expected = alone_after(kSteps, 21);
  for (const int threads : {1, 2}) {
    // Never even enough for this one: it cuts itself whenever it has looked.
    World world = rain(Communicator(), threads, 0.5e-3, 21, 0.0);
    int done = 0;
    int cuts = 0;
    for (const int stop : {250, 700, 1100}) {
      run(world, stop - done);
      done = stop;
      cut_anew(world, static_cast<std::uint64_t>(stop));
      run(world, 1);
      ++done;
      State state;
      world.save_state(state);
      World next = rain(Communicator(), 3 - threads, 0.4e-3, 99, 0.0);
      next.load_state(state);
      cuts += world.cuts();
      world = std::move(next);
    }
    run(world, kSteps - done);
    ASSERT_EQ(hash_of(world), expected) << "begun with " << threads << " threads";
    if (Communicator().size() > 1) {
      EXPECT_GT(cuts + world.cuts(), 3);
    }
  }
}

TEST(Threads, RestartGoesOnBitForBitWithAnotherNumberOfThreads) {
  const std::uint64_t expected = alone_after(kSteps, 22);
  World world = rain(Communicator(), 2, 0.5e-3, 22);
  int done = 0;
  int threads = 3;
  for (const int stop : {1, 333, 1000}) {
    run(world, stop - done);
    done = stop;
    State state;
    world.save_state(state);
    World fresh = rain(Communicator(), threads, 0.4e-3, 99);
    fresh.load_state(state);
    ASSERT_EQ(hash_of(fresh), hash_of(world)) << "right after loading at step " << stop;
    world = std::move(fresh);
    threads = threads % 4 + 1;
  }
  run(world, kSteps - done);
  EXPECT_EQ(hash_of(world), expected);
}

TEST(Threads, ANanOfAnyThreadIsNoticed) {
  for (const int which : {0, 700, 1300, kGrains - 1}) {
    World world = rain(Communicator(), 4, 0.5e-3, 23);
    State state;
    world.save_state(state);
    for (StateTable& table : state)
      for (std::size_t row = 0; table.name == "particles" && row < table.rows(); ++row)
        if (table.integers[row * table.integer_width()] == which)
          table.reals[row * table.real_width() + 3] = std::numeric_limits<double>::quiet_NaN();
    world.load_state(state);
    EXPECT_EQ(world.step().fault, Fault::kNotANumber) << "grain " << which;
  }
}

}  // namespace
}  // namespace grouser
