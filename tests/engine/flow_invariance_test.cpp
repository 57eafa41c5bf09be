// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/random.hpp"
#include "engine/lbm/flow.hpp"

namespace grouser {
namespace {

// Run under mpirun with any number of ranks; the first also runs the same on its own to compare.

std::uint64_t hash_of(const Communicator& ranks, const Flow& flow, std::int64_t pieces = 1) {
  StateHash hash;
  for (std::int64_t piece = 0; piece < pieces; ++piece) {
    State state;
    flow.save_state(state, {piece, pieces});
    for (const StateTable& table : state) hash.add(table);
  }
  return hash.value(ranks);
}

std::uint64_t from_first(std::uint64_t value) {
  return static_cast<std::uint64_t>(Communicator().from_first(static_cast<std::int64_t>(value)));
}

// All kinds of ends and bodies at once, with blocks that do not halve the lattice.
FlowSettings crowded(const std::string& lattice, Precision precision, int kind) {
  FlowSettings s;
  s.lattice = lattice;
  s.precision = precision;
  s.collision = kCollisions[static_cast<std::size_t>(kind) % kCollisions.size()];
  s.parameters.viscosity_lu = 0.03;
  s.parameters.smagorinsky = 0.15;
  const bool flat = lattice == "D2Q9";
  s.cells = {21, flat ? 23 : 13, flat ? 1 : 11};
  s.force_lu = {1e-5, 2e-5, flat ? 0.0 : -1e-5};
  const auto set = [&](std::size_t axis, FaceKind low, FaceKind high) {
    s.faces[axis][0].kind = low;
    s.faces[axis][1].kind = high;
  };
  if (kind == 0) set(0, FaceKind::kVelocity, FaceKind::kPressure);
  if (kind == 1) set(1, FaceKind::kWall, FaceKind::kSlip);
  if (kind == 2) set(1, FaceKind::kVelocity, FaceKind::kOutflow);
  if (kind == 3 && !flat) set(2, FaceKind::kSlip, FaceKind::kWall);
  for (auto& ends : s.faces)
    for (Face& face : ends) {
      if (face.kind == FaceKind::kVelocity) face.velocity_lu = {0.02, 0.01, 0.0};
      if (face.kind == FaceKind::kWall) face.velocity_lu = {0.03, 0.0, 0.01};
    }
  if (kind == 0)
    s.faces[0][0].profile = [](const Vec3& p) { return Vec3{0.02 + 0.001 * p.y, 0.01, 0.0}; };
  const Vec3 centre{9.3, 6.2, flat ? 0.0 : 5.4};
  s.obstacles.push_back({[centre](const Vec3& p) { return norm(p - centre) - 2.7; }});
  s.obstacles[0].interpolated = kind % 2 == 0;
  s.obstacles[0].spin_lu = {0.0, 0.0, 0.01};
  s.obstacles[0].centre = centre;
  return s;
}

std::unique_ptr<Flow> swirling(const Communicator& ranks, const FlowSettings& settings) {
  auto flow = make_flow(ranks, settings);
  flow->set_equilibrium([&](const Vec3& p) {
    const auto cell = static_cast<std::uint64_t>(p.x + 100.0 * p.y + 10000.0 * p.z);
    const auto draw = [&](std::uint64_t k) { return 0.04 * (random_unit(5, cell, k) - 0.5); };
    return FlowNode{1.0 + draw(0), {draw(1), draw(2), settings.cells[2] == 1 ? 0.0 : draw(3)}};
  });
  return flow;
}

template <class Check>
void each_case(const Check& check) {
  for (const char* lattice : kLattices)
    for (const Precision precision : {Precision::kDouble, Precision::kSingle})
      for (int kind = 0; kind < 4; ++kind) {
        SCOPED_TRACE(std::string(lattice) + " kind " + std::to_string(kind) +
                     (precision == Precision::kDouble ? " double" : " single"));
        check(crowded(lattice, precision, kind));
      }
}

TEST(FlowInvariance, TheSameBitsOnAnyNumberOfRanks) {
  each_case([](const FlowSettings& settings) {
    const auto together = swirling(Communicator(), settings);
    const auto alone = swirling(Communicator::alone(), settings);
    for (const int steps : {1, 30}) {
      for (int k = 0; k < steps; ++k) together->step();
      if (Communicator().rank() == 0)
        for (int k = 0; k < steps; ++k) alone->step();
      ASSERT_EQ(hash_of(Communicator(), *together),
                from_first(hash_of(Communicator::alone(), *alone)));
    }
    const FlowTotals totals = together->totals();
    EXPECT_TRUE(totals.finite);
    EXPECT_GT(totals.max_speed_lu, 0.005);
    const FluidLoad load = together->loads()[0];
    const FluidLoad expected = alone->loads()[0];
    if (Communicator().rank() == 0) {
      EXPECT_EQ(load.force_lu, expected.force_lu);
      EXPECT_EQ(load.moment_lu, expected.moment_lu);
      EXPECT_GT(norm(load.moment_lu), 0.0);
    }
  });
}

TEST(FlowRestart, ContinuesBitForBitAfterEvenAndOddSteps) {
  each_case([](const FlowSettings& settings) {
    const auto straight = swirling(Communicator(), settings);
    auto cut = swirling(Communicator(), settings);
    int done = 0;
    for (const int stop : {3, 8, 15}) {
      for (; done < stop; ++done) {
        straight->step();
        cut->step();
      }
      // In pieces, and on other ranks than those that own the cells.
      auto fresh = make_flow(Communicator(), settings);
      fresh->begin_load();
      for (std::int64_t piece = 0; piece < 3; ++piece) {
        State state;
        cut->save_state(state, {piece, 3});
        for (StateTable& table : state) {
          sort_rows(Communicator(), table, {piece, 3});
          fresh->load_rows(table);
        }
      }
      fresh->end_load();
      EXPECT_EQ(fresh->steps(), stop);
      ASSERT_EQ(hash_of(Communicator(), *fresh), hash_of(Communicator(), *cut));
      cut = std::move(fresh);
    }
    ASSERT_EQ(hash_of(Communicator(), *straight), hash_of(Communicator(), *cut));
    EXPECT_EQ(hash_of(Communicator(), *cut), hash_of(Communicator(), *cut, 5));
  });
}

TEST(FlowRestart, RefusesTheStateOfAnotherLattice) {
  const FlowSettings settings = crowded("D3Q19", Precision::kDouble, 0);
  State state;
  swirling(Communicator(), settings)->save_state(state);
  FlowSettings other = settings;
  other.lattice = "D3Q15";
  EXPECT_THROW(make_flow(Communicator(), other)->load_state(state), FormatError);
  other = settings;
  other.cells[1] += 1;
  EXPECT_THROW(make_flow(Communicator(), other)->load_state(state), FormatError);
  other = settings;
  other.obstacles.clear();
  EXPECT_THROW(make_flow(Communicator(), other)->load_state(state), FormatError);
}

// Balls across the cuts between ranks, across ends and over each other, that move and turn.
std::vector<ImmersedBall> balls(int step) {
  std::vector<ImmersedBall> all;
  for (std::uint64_t b = 0; b < 12; ++b) {
    const auto draw = [&](std::uint64_t k) { return random_unit(11, b, k); };
    const Vec3 velocity{0.05 * (draw(0) - 0.5), 0.05 * (draw(1) - 0.5), 0.05 * (draw(2) - 0.5)};
    all.push_back({Vec3{20.0 * draw(3), 12.0 * draw(4), 10.0 * draw(5)} + step * velocity,
                   1.5 + 2.0 * draw(6),
                   velocity,
                   {0.01 * draw(7), 0.0, -0.01 * draw(8)}});
  }
  return all;
}

// Sums over ranks, so that they can be compared.
std::vector<Vec3> total_loads(const Communicator& ranks, const Flow& flow) {
  Communicator::StepTotals totals;
  for (const ImmersedLoad& load : flow.immersed_loads()) {
    totals.sums.insert(totals.sums.end(), load.force.begin(), load.force.end());
    totals.sums.insert(totals.sums.end(), load.moment.begin(), load.moment.end());
  }
  ranks.combine(totals);
  std::vector<Vec3> values;
  for (std::size_t i = 0; i < totals.sums.size(); i += 3)
    values.push_back(
        {totals.sums[i].value(), totals.sums[i + 1].value(), totals.sums[i + 2].value()});
  return values;
}

TEST(FlowInvariance, MovingBallsAndTheirLoadsAreTheSameBitsOnAnyNumberOfRanks) {
  each_case([](const FlowSettings& settings) {
    if (settings.lattice == "D2Q9") return;
    const auto together = swirling(Communicator(), settings);
    const auto alone = swirling(Communicator::alone(), settings);
    for (int step = 0; step < 15; ++step) {
      together->immerse(balls(step));
      together->step();
      alone->immerse(balls(step));
      alone->step();
      ASSERT_EQ(total_loads(Communicator(), *together), total_loads(Communicator::alone(), *alone));
    }
    ASSERT_EQ(hash_of(Communicator(), *together),
              from_first(hash_of(Communicator::alone(), *alone)));
    EXPECT_TRUE(together->totals().finite);
    EXPECT_GT(norm(total_loads(Communicator(), *together)[0]), 0.0);
  });
}

TEST(CellBlocks, MoreRanksThanRowsAllowAreRefused) {
  FlowSettings settings;
  settings.cells = {16, 2, 2};
  if (Communicator().size() == 1)
    make_flow(Communicator(), settings);
  else
    EXPECT_THROW(make_flow(Communicator(), settings), ConfigError);
}

}  // namespace
}  // namespace grouser
