// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/terrain/wheel.hpp"
#include "tests/engine/drum_world.hpp"
#include "tests/engine/reference_world.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {
namespace {

// Run under mpirun with any number of ranks; the first also runs the same on its own to compare.

// Grains that rain into a box with a spinning drum in the middle of it.
World rain(const Communicator& ranks, double skin, std::uint64_t seed, double speed = 1.0,
           double uneven = 1.05) {
  WorldSettings settings = rolling_settings(skin);
  settings.uneven = uneven;
  World world(ranks, settings);
  add_box_and_drum(world, 0.05, {0.05, 0.05, 0.06}).spin = 20.0;
  const std::vector<Particle> grains = loose_column(243, seed);
  add_share(world, 243, [&](std::size_t i) {
    Particle p = grains[i];
    p.position.z += 0.1;
    p.velocity.z -= speed;
    return p;
  });
  return world;
}

// Steps and moves the drum by what the grains do to it, so that body loads enter the trajectory.
void run(World& world, int steps) {
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(world.step().fault, Fault::kNone);
    drive_drum(world);
  }
}

TEST(Invariance, TrajectoryIsTheSameBitForBitOnAnyNumberOfRanks) {
  World together = rain(Communicator(), 1e-3, 5);
  World alone = rain(Communicator::alone(), 1e-3, 5);
  for (int leg = 0; leg < 3; ++leg) {
    run(together, 8000);
    if (Communicator().rank() == 0) run(alone, 8000);
    const auto expected = static_cast<std::uint64_t>(
        Communicator().from_first(static_cast<std::int64_t>(hash_of(alone))));
    ASSERT_EQ(hash_of(together), expected) << "after leg " << leg;
  }
  // The test means something only when grains touched, moved between ranks and hit the drum.
  EXPECT_GT(together.contacts(), 200);
  EXPECT_NE(together.body(1).motion.spin, 20.0);
}

TEST(Invariance, TrajectoryIsTheSameHoweverOftenAndWhereverSpaceIsCut) {
  // Ranks are never even enough for this one: it cuts itself whenever it has looked.
  World restless = rain(Communicator(), 1e-3, 10, 4.0, 0.0);
  World shuffled = rain(Communicator(), 1e-3, 10, 4.0);
  World alone = rain(Communicator::alone(), 1e-3, 10, 4.0);
  std::size_t least = 1000;
  std::int64_t most = 0;
  for (std::uint64_t leg = 0; leg < 10; ++leg) {
    run(restless, 400);
    cut_anew(shuffled, leg);
    run(shuffled, 400);
    if (Communicator().rank() == 0) run(alone, 400);
    const auto expected = static_cast<std::uint64_t>(
        Communicator().from_first(static_cast<std::int64_t>(hash_of(alone))));
    ASSERT_EQ(hash_of(shuffled), expected) << "after leg " << leg;
    ASSERT_EQ(hash_of(restless), expected) << "after leg " << leg;
    most = std::max(most, shuffled.contacts());
    least = std::min(least, shuffled.owned());
  }
  EXPECT_GT(most, 40);
  if (Communicator().size() == 1) return;
  EXPECT_GT(restless.cuts(), 20);
  EXPECT_LT(Communicator().max(static_cast<std::int64_t>(least)), 120);
}

// A block of many grains that is pressed together, so that ranks have whole chunks of grains that
// touch no ghost and go on while ghosts are still on their way.
World pressed(const Communicator& ranks) {
  WorldSettings settings = small_settings();
  settings.rolling = "elastic_plastic";
  settings.largest_radius = 2.5e-3;
  settings.skin = 0.3e-3;
  settings.time_step = 5e-6;
  settings.top = 0.06;
  World world(ranks, settings);
  add_box(world, {0.5, 0.4, 0.05});
  constexpr int kSide = 20;
  constexpr int kHeight = 12;
  for (int i = 0; i < kSide * kSide * kHeight; ++i) {
    const auto item = static_cast<std::uint64_t>(i);
    Particle p = sphere(i, 2e-3 + 5e-4 * random_unit(12, item, 0),
                        {0.005 * (i % kSide + 0.5), 0.005 * (i / kSide % kSide + 0.5),
                         0.005 * (i / (kSide * kSide) + 0.5)});
    p.velocity = 20.0 * (Vec3{0.05, 0.05, 0.03} - p.position);
    p.velocity.x += random_unit(12, item, 1) - 0.5;
    if (world.owns(p.position)) world.add_particle(p);
  }
  return world;
}

TEST(Invariance, GrainsThatDoNotWaitForGhostsGiveTheSameBits) {
  World together = pressed(Communicator());
  World alone = pressed(Communicator::alone());
  for (int i = 0; i < 300; ++i) ASSERT_EQ(together.step().fault, Fault::kNone);
  for (int i = 0; i < 300 && Communicator().rank() == 0; ++i)
    ASSERT_EQ(alone.step().fault, Fault::kNone);
  const auto expected = static_cast<std::uint64_t>(
      Communicator().from_first(static_cast<std::int64_t>(hash_of(alone))));
  EXPECT_EQ(hash_of(together), expected);
  EXPECT_GT(together.contacts(), 500);
}

// A wheel that comes to a grain at rest: by driving, or by a grouser that turns towards it. Nothing
// but the wheel's own motion can tell the lists that it is near.
Particle struck_by(double speed, double spin, const Vec3& grain, double skin) {
  WorldSettings settings = small_settings();
  settings.gravity = 0.0;
  settings.skin = skin;
  World world(Communicator::alone(), settings);
  WheelCase wheel;
  wheel.profile = "grousers";
  wheel.diameter = 0.04;
  wheel.width = 0.04;
  wheel.facets = 36;
  wheel.grousers = 1;
  wheel.grouser_height = 0.01;
  wheel.grouser_width = 0.002;
  const std::size_t body =
      world.add_body("wheel", wheel_mesh(wheel), kTestSolid, {0.5, 0.6, 0.1}, true);
  BodyMotion& motion = world.body(body).motion;
  motion.position = {0.03, 0.05, 0.1};
  motion.velocity.x = speed;
  motion.spin = spin;
  world.add_particle(sphere(0, 4e-3, grain));
  // Till shortly after the blow, before the grain leaves the box.
  for (int i = 0, since = 0; i < 4000 && since < 200; ++i) {
    EXPECT_EQ(world.step().fault, Fault::kNone);
    if (norm(world.particles()[0].velocity) > 0.0) ++since;
    motion.position += settings.time_step * motion.velocity;
    motion.angle += settings.time_step * motion.spin;
  }
  return world.particles()[0];
}

TEST(Invariance, ABodyFindsGrainsAtRestOnItsWay) {
  const auto expect_struck = [](double speed, double spin, const Vec3& grain) {
    const Particle thin = struck_by(speed, spin, grain, 0.2e-3);
    const Particle thick = struck_by(speed, spin, grain, 3e-3);
    EXPECT_GT(norm(thin.velocity), 0.1);
    EXPECT_EQ(thin.position, thick.position);
    EXPECT_EQ(thin.velocity, thick.velocity);
  };
  // Not a whole number of skins away, after which the lists are made anew in any case.
  expect_struck(2.0, 0.0, {0.0665, 0.05, 0.1});
  // Beside the drum of radius 10 mm, in reach of the grouser's tip alone.
  expect_struck(0.0, 320.0, {0.03, 0.05, 0.083});
  expect_struck(0.0, 320.0, {0.03, 0.05, 0.117});
}

TEST(Invariance, TrajectoryDoesNotDependOnTheSkin) {
  World thin = rain(Communicator(), 0.2e-3, 6);
  World thick = rain(Communicator(), 3e-3, 6);
  run(thin, 12000);
  run(thick, 12000);
  EXPECT_EQ(hash_of(thin), hash_of(thick));
}

TEST(Restart, ContinuesBitForBitFromAnyStep) {
  World straight = rain(Communicator(), 1e-3, 7);
  World cut = rain(Communicator(), 1e-3, 7);
  run(straight, 12000);
  int done = 0;
  for (const int stop : {1, 500, 4321, 9999, 12000}) {
    run(cut, stop - done);
    done = stop;
    State state;
    cut.save_state(state);
    World fresh = rain(Communicator(), 0.7e-3, 99);  // other grains, until the state replaces them
    fresh.load_state(state);
    ASSERT_EQ(hash_of(fresh), hash_of(cut)) << "right after loading at step " << stop;
    cut = std::move(fresh);
  }
  EXPECT_EQ(hash_of(straight), hash_of(cut));
}

TEST(Restart, StateMovesBetweenNumbersOfRanks) {
  World together = rain(Communicator(), 1e-3, 8);
  run(together, 2500);
  cut_anew(together, 8);
  run(together, 2500);
  State state;
  together.save_state(state);
  // Every rank gets all rows and goes on alone.
  for (StateTable& table : state) {
    std::vector<Bytes> out(static_cast<std::size_t>(Communicator().size()));
    for (Bytes& to : out) {
      const std::size_t counts[2] = {table.integers.size(), table.reals.size()};
      append_bytes(to, counts, 2);
      append_bytes(to, table.integers.data(), counts[0]);
      append_bytes(to, table.reals.data(), counts[1]);
    }
    table.integers.clear();
    table.reals.clear();
    for (const Bytes& message : Communicator().exchange_all(out)) {
      ByteReader reader(message);
      std::size_t counts[2];
      reader.take(counts, 2);
      table.integers.resize(table.integers.size() + counts[0]);
      reader.take(table.integers.data() + table.integers.size() - counts[0], counts[0]);
      table.reals.resize(table.reals.size() + counts[1]);
      reader.take(table.reals.data() + table.reals.size() - counts[1], counts[1]);
    }
  }
  World alone = rain(Communicator::alone(), 1e-3, 99);
  alone.load_state(state);
  run(together, 5000);
  if (Communicator().rank() == 0) run(alone, 5000);
  const auto expected = static_cast<std::uint64_t>(
      Communicator().from_first(static_cast<std::int64_t>(hash_of(alone))));
  EXPECT_EQ(hash_of(together), expected);
}

TEST(Oracle, ListsAndCellsGiveTheBitsOfBruteForce) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    WorldSettings settings = small_settings();
    settings.rolling = "elastic_plastic";
    settings.low = {-1, -1, -1};
    settings.high = {1, 1, 1};
    settings.gravity = 1.0;
    std::vector<Particle> grains = loose_column(120, seed);
    settings.time_step = 1e-5;
    // A cloud that falls together, so that contacts open and close.
    for (Particle& p : grains) p.velocity = 30.0 * (Vec3{0.05, 0.05, 0.01} - p.position);
    World world{Communicator(), settings};
    for (const Particle& p : grains)
      if (p.id % Communicator().size() == Communicator().rank()) world.add_particle(p);
    ReferenceWorld oracle(grains, settings.grain, settings.grain_grain, settings.gravity,
                          settings.time_step);
    std::int64_t most = 0;
    for (int i = 0; i < 1500; ++i) {
      ASSERT_EQ(world.step().fault, Fault::kNone);
      oracle.step();
      most = std::max(most, world.contacts());
    }
    EXPECT_GT(most, 40);
    for (std::size_t i = 0; i < world.owned(); ++i) {
      const Particle& p = world.particles()[i];
      const Particle& q = oracle.grains()[static_cast<std::size_t>(p.id)];
      ASSERT_EQ(p.position, q.position) << "seed " << seed << " grain " << p.id;
      ASSERT_EQ(p.velocity, q.velocity);
      ASSERT_EQ(p.spin, q.spin);
    }
  }
}

TEST(Oracle, BoxAndWheelGiveTheBitsOfALoopOverAllFacets) {
  WorldSettings settings = small_settings();
  settings.rolling = "elastic_plastic";
  settings.time_step = 1e-5;
  std::vector<Particle> grains = loose_column(100, 4);
  // They come down on a wheel that drives and turns, slide off it and reach walls and floor.
  for (Particle& p : grains) {
    p.position.z += 0.095;
    p.velocity.z -= 2.5;
    p.velocity.x += 40.0 * (p.position.x - 0.05);
  }
  WheelCase wheel;
  wheel.profile = "grousers";
  wheel.diameter = 0.07;
  wheel.width = 0.05;
  wheel.facets = 36;
  wheel.grousers = 9;
  wheel.grouser_height = 0.006;
  wheel.grouser_width = 0.003;
  const Surface box_surface{0.5, 0.4, 0.05};
  const Surface wheel_surface{0.5, 0.6, 0.1};
  BodyMotion motion;
  motion.position = {0.045, 0.05, 0.05};
  motion.velocity = {0.1, 0.0, -0.05};
  motion.spin = 25.0;

  World world{Communicator(), settings};
  add_box(world, box_surface);
  world.add_body("wheel", wheel_mesh(wheel), kTestSolid, wheel_surface, true);
  for (const Particle& p : grains)
    if (p.id % Communicator().size() == Communicator().rank()) world.add_particle(p);
  ReferenceWorld oracle(grains, settings.grain, settings.grain_grain, settings.gravity,
                        settings.time_step);
  oracle.add_body(box_mesh(settings.high.x, settings.high.y, settings.high.z), kTestSolid,
                  box_surface);
  oracle.add_body(wheel_mesh(wheel), kTestSolid, wheel_surface);
  std::size_t most = 0;
  std::size_t at_edges = 0;
  bool reached_floor = false;
  for (int i = 0; i < 4000; ++i) {
    world.body(1).motion = oracle.motion(1) = motion;
    ASSERT_EQ(world.step().fault, Fault::kNone);
    oracle.step();
    motion.position += settings.time_step * motion.velocity;
    motion.angle += settings.time_step * motion.spin;
    for (std::size_t body = 0; body < 2; ++body)
      ASSERT_EQ(world.load(body).force_z.value(), oracle.force_z(body).value())
          << "body " << body << " step " << i;
    most = std::max(most, oracle.touches());
    at_edges += oracle.edge_touches();
    reached_floor = reached_floor || oracle.force_z(0).value() < -1.0;
  }
  EXPECT_GT(most, 12u);
  EXPECT_GT(at_edges, 1000u);
  EXPECT_TRUE(reached_floor);
  for (std::size_t i = 0; i < world.owned(); ++i) {
    const Particle& p = world.particles()[i];
    const Particle& q = oracle.grains()[static_cast<std::size_t>(p.id)];
    ASSERT_EQ(p.position, q.position) << "grain " << p.id;
    ASSERT_EQ(p.velocity, q.velocity);
    ASSERT_EQ(p.spin, q.spin);
  }
}

TEST(Faults, ANanIsAgreedByAllRanks) {
  World world = rain(Communicator(), 1e-3, 9);
  State state;
  world.save_state(state);
  for (StateTable& table : state)
    if (table.name == "particles" && Communicator().rank() == 0)
      table.reals[3] = std::numeric_limits<double>::quiet_NaN();
  world.load_state(state);
  EXPECT_EQ(world.step().fault, Fault::kNotANumber);
}

TEST(Faults, AParticleOutsideTheBoxIsAgreedByAllRanks) {
  World world = rain(Communicator(), 1e-3, 9);
  State state;
  world.save_state(state);
  for (StateTable& table : state)
    if (table.name == "particles" && Communicator().rank() == 0) table.reals[2] = -0.5;
  world.load_state(state);
  EXPECT_EQ(world.step().fault, Fault::kLostParticle);
}

}  // namespace
}  // namespace grouser
