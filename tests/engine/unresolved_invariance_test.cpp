// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/random.hpp"
#include "engine/coupling/unresolved_flow.hpp"

namespace grouser {
namespace {

// Run under mpirun with any number of ranks; the first also runs the same on its own to compare.

constexpr int kCount = 400;

UnresolvedSettings shaken_box() {
  UnresolvedSettings s;
  s.lattice.cells = {9, 8, 10};
  for (Face& face : s.lattice.faces[2]) face.kind = FaceKind::kWall;
  for (Face& face : s.lattice.faces[0]) face.kind = FaceKind::kSlip;
  s.cell = 0.01;
  s.time_step = 1e-3;
  s.fluid = {1000.0, 0.01};
  return s;
}

// Grains that fly about without contacts, spread over ranks by their ids, which change hands.
class Swarm {
 public:
  explicit Swarm(const Communicator& ranks) : ranks_(ranks), flow_(ranks, shaken_box()) {
    std::uint64_t draws = 0;
    const auto draw = [&] { return random_unit(17, 4, draws++); };
    for (int id = 0; id < kCount; ++id) {
      GrainInFlow g;
      g.id = id;
      g.position = {0.09 * draw(), 0.08 * draw(), 0.1 * draw()};
      g.velocity = 0.3 * Vec3{draw() - 0.5, draw() - 0.5, draw() - 0.5};
      g.radius = 0.001 + 0.002 * draw();
      g.mass = 2500.0 * 4.2 * std::pow(g.radius, 3);
      g.other_force = {0.0, 0.0, -9.81 * 0.6 * g.mass};
      if (id % ranks.size() == ranks.rank()) grains_.push_back(g);
    }
    pores_ = flow_.look(grains_);
  }

  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      const auto forces = flow_.step(grains_, pores_);
      for (std::size_t g = 0; g < grains_.size(); ++g) move(grains_[g], forces[g]);
    }
  }

  // Fluid and grains.
  State state() const {
    State state;
    flow_.save_state(state);
    StateTable table;
    table.name = "swarm";
    table.key_count = table.all_rows = kCount;
    table.real_fields = {{"motion", "1", 6}, {"pore", "1", 7}};
    for (std::size_t g = 0; g < grains_.size(); ++g) {
      const auto& [id, p, v, radius, mass, other] = grains_[g];
      const auto& [u, n, gradient] = pores_[g];
      table.integers.insert(table.integers.end(), {id, 0});
      table.reals.insert(table.reals.end(), {p.x, p.y, p.z, v.x, v.y, v.z, u.x, u.y, u.z, n,
                                             gradient.x, gradient.y, gradient.z});
    }
    state.push_back(std::move(table));
    return state;
  }
  std::uint64_t hash() const { return hash_state(ranks_, state()); }
  void take_fluid(const State& state) { flow_.load_state(state); }
  void take_grains(const Swarm& other) {
    grains_ = other.grains_;
    pores_ = other.pores_;
  }
  double least_void_fraction() const { return flow_.least_void_fraction(); }

 private:
  static void move(GrainInFlow& g, const Vec3& force) {
    g.velocity += (1e-3 / g.mass) * (force + g.other_force);
    g.position += 1e-3 * g.velocity;
    g.position.y = std::fmod(g.position.y + 0.08, 0.08);
    for (double* at : {&g.position.x, &g.position.z}) {
      const double size = at == &g.position.x ? 0.09 : 0.1;
      double& v = at == &g.position.x ? g.velocity.x : g.velocity.z;
      if ((*at < 0.0 && v < 0.0) || (*at > size && v > 0.0)) v = -v;
    }
  }

  Communicator ranks_;
  UnresolvedFlow flow_;
  std::vector<GrainInFlow> grains_;
  std::vector<PoreState> pores_;
};

TEST(UnresolvedInvariance, TheSameBitsOnAnyNumberOfRanks) {
  Swarm together{Communicator()};
  Swarm alone{Communicator::alone()};
  for (const int steps : {1, 50}) {
    together.run(steps);
    if (Communicator().rank() == 0) alone.run(steps);
    const auto expected = static_cast<std::uint64_t>(
        Communicator().from_first(static_cast<std::int64_t>(alone.hash())));
    ASSERT_EQ(together.hash(), expected) << "after " << steps;
  }
  EXPECT_LT(together.least_void_fraction(), 0.95);
}

TEST(UnresolvedRestart, ContinuesBitForBitAfterEvenAndOddSteps) {
  for (const int before : {20, 21}) {
    Swarm straight{Communicator()};
    straight.run(before);
    Swarm resumed{Communicator()};
    resumed.take_fluid(straight.state());
    resumed.take_grains(straight);
    EXPECT_EQ(resumed.hash(), straight.hash());
    straight.run(15);
    resumed.run(15);
    ASSERT_EQ(resumed.hash(), straight.hash());
  }
}

}  // namespace
}  // namespace grouser
