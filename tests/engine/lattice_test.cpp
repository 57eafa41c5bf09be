// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/random.hpp"
#include "tests/engine/reference_lattice.hpp"

namespace grouser {
namespace {

template <class Set>
class EveryLattice : public ::testing::Test {};
using Lattices = ::testing::Types<D2Q9, D3Q15, D3Q19, D3Q27>;
TYPED_TEST_SUITE(EveryLattice, Lattices);

double component(const LatticeVelocity& c, int axis) {
  return axis == 0 ? c.x : axis == 1 ? c.y : c.z;
}

TYPED_TEST(EveryLattice, HasTheMomentsOfAMaxwellDistributionUpToTheFifth) {
  constexpr int kD = TypeParam::kDimensions;
  const auto moment = [](std::initializer_list<int> axes) {
    double sum = 0.0;
    for (std::size_t i = 0; i < TypeParam::kVelocities; ++i) {
      double term = TypeParam::kSet.weights[i];
      for (const int a : axes) term *= component(TypeParam::kSet.velocities[i], a);
      sum += term;
    }
    return sum;
  };
  const auto same = [](int a, int b) { return a == b ? 1.0 : 0.0; };
  constexpr double kRounding = 1e-15;
  EXPECT_NEAR(moment({}), 1.0, kRounding);
  for (int a = 0; a < kD; ++a) {
    EXPECT_NEAR(moment({a}), 0.0, kRounding);
    for (int b = 0; b < kD; ++b) {
      EXPECT_NEAR(moment({a, b}), same(a, b) / 3.0, kRounding);
      for (int c = 0; c < kD; ++c) {
        EXPECT_NEAR(moment({a, b, c}), 0.0, kRounding);
        for (int d = 0; d < kD; ++d) {
          EXPECT_NEAR(
              moment({a, b, c, d}),
              (same(a, b) * same(c, d) + same(a, c) * same(b, d) + same(a, d) * same(b, c)) / 9.0,
              kRounding);
          for (int e = 0; e < kD; ++e) EXPECT_NEAR(moment({a, b, c, d, e}), 0.0, kRounding);
        }
      }
    }
  }
}

TYPED_TEST(EveryLattice, PairsOppositeVelocities) {
  for (std::size_t i = 0; i < TypeParam::kVelocities; ++i) {
    const LatticeVelocity a = TypeParam::kSet.velocities[i];
    const LatticeVelocity b = TypeParam::kSet.velocities[opposite(i)];
    EXPECT_EQ(a.x, -b.x);
    EXPECT_EQ(a.y, -b.y);
    EXPECT_EQ(a.z, -b.z);
  }
}

FlowSettings random_case(const std::string& lattice, const std::string& collision,
                         std::uint64_t seed) {
  std::uint64_t stream = 0;
  const auto draw = [&] { return random_unit(seed, 7, stream++); };
  FlowSettings s;
  s.lattice = lattice;
  s.collision = collision;
  s.parameters.viscosity_lu = 0.005 + 0.3 * draw();
  s.parameters.magic = 0.1 + 0.3 * draw();
  s.parameters.bulk_rate = 0.3 + 1.5 * draw();
  s.parameters.higher_rate = 0.3 + 1.5 * draw();
  s.parameters.smagorinsky = 0.3;
  const bool flat = lattice == "D2Q9";
  s.cells = {5 + static_cast<std::int64_t>(30 * draw()), 3 + static_cast<std::int64_t>(6 * draw()),
             flat ? 1 : 3 + static_cast<std::int64_t>(4 * draw())};
  for (std::size_t a = 0; a < (flat ? 2u : 3u); ++a)
    if (draw() < 0.5)
      for (Face& face : s.faces[a]) {
        face.kind = FaceKind::kWall;
        face.velocity_lu = {0.1 * draw(), 0.1 * draw(), flat ? 0.0 : 0.1 * draw()};
      }
  if (draw() < 0.7) s.force_lu = {1e-3 * draw(), -1e-3 * draw(), flat ? 0.0 : 1e-3 * draw()};
  if (draw() < 0.7) {
    const Vec3 centre{draw() * static_cast<double>(s.cells[0]),
                      draw() * static_cast<double>(s.cells[1]),
                      draw() * static_cast<double>(s.cells[2])};
    s.obstacles.push_back({[centre](const Vec3& p) { return norm(p - centre) - 1.6; }});
    s.obstacles.back().velocity_lu = {0.05 * draw(), 0.05 * draw(), 0.0};
  }
  return s;
}

// Largest difference between engine and oracle over all populations of fluid after some steps from
// populations drawn at random. `largest` gets the largest population.
template <class Set>
double difference(const FlowSettings& settings, std::uint64_t seed, int steps, double& largest) {
  const std::unique_ptr<Flow> flow = make_flow(Communicator::alone(), settings);
  ReferenceLattice<Set> oracle(settings);
  const CellCounts n = settings.cells;
  State state;
  flow->save_state(state);
  std::size_t row = 0;
  StateTable& table = state[0];
  for (; row < table.rows(); ++row) {
    const std::int64_t key = table.integers[2 * row];
    for (std::size_t i = 0; i < Set::kVelocities; ++i) {
      const double value = Set::kSet.weights[i] *
                           (0.1 * random_unit(seed, static_cast<std::uint64_t>(key), i) - 0.05);
      const auto stored =
          settings.precision == Precision::kSingle ? double{static_cast<float>(value)} : value;
      table.reals[row * Set::kVelocities + i] = stored;
      oracle.set(i, key % n[0], key / n[0] % n[1], key / (n[0] * n[1]), stored);
    }
  }
  flow->load_state(state);
  for (int k = 0; k < steps; ++k) {
    flow->step();
    oracle.step();
  }
  double worst = 0.0;
  for (std::int64_t z = 0; z < n[2]; ++z)
    for (std::int64_t y = 0; y < n[1]; ++y)
      for (std::int64_t x = 0; x < n[0]; ++x) {
        EXPECT_EQ(flow->is_fluid(x, y, z), oracle.is_fluid(x, y, z));
        if (!oracle.is_fluid(x, y, z)) continue;
        for (std::size_t i = 0; i < Set::kVelocities; ++i) {
          worst = std::max(worst, std::abs(flow->population(i, x, y, z) - oracle.get(i, x, y, z)));
          largest = std::max(largest, std::abs(oracle.get(i, x, y, z)));
        }
      }
  return worst;
}

TYPED_TEST(EveryLattice, StepsInPlaceAsTheTextbookDoesWithTwoArrays) {
  // Even and odd steps, whole and broken registers, every collision.
  for (const char* collision : kCollisions)
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      FlowSettings settings = random_case(TypeParam::kName, collision, seed);
      const int steps = 6 + static_cast<int>(seed % 2);
      double largest = 0.0;
      const double in_double = difference<TypeParam>(settings, seed, steps, largest);
      EXPECT_LT(in_double, 2e-15) << collision << ", seed " << seed;  // weights are kept by one
      settings.precision = Precision::kSingle;
      const double in_single = difference<TypeParam>(settings, seed, steps, largest);
      // Zero-centred: single precision is lost against the deviations, not against one.
      EXPECT_LT(in_single, 60 * 6e-8 * largest) << collision << ", seed " << seed;
      EXPECT_GT(largest, 1e-4);
    }
}

FlowSettings good() {
  FlowSettings s;
  s.cells = {8, 8, 8};
  return s;
}

void expect_refused(const FlowSettings& settings, const std::string& about) {
  try {
    make_flow(Communicator::alone(), settings);
    ADD_FAILURE() << "taken though " << about << " makes no sense";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find(about), std::string::npos) << error.what();
  }
}

TEST(Flow, SettingsThatMakeNoSenseAreRefusedByName) {
  make_flow(Communicator::alone(), good());
  FlowSettings s = good();
  s.lattice = "D3Q18";
  expect_refused(s, "D3Q18");
  s = good();
  s.collision = "bkg";
  expect_refused(s, "bgk");
  s = good();
  s.parameters.viscosity_lu = 0.0;
  expect_refused(s, "relaxation time");
  s = good();
  s.cells[1] = 0;
  expect_refused(s, "along y");
  s = good();
  s.faces[2][0].kind = FaceKind::kWall;
  expect_refused(s, "periodic at one end");
  s = good();
  s.lattice = "D2Q9";
  expect_refused(s, "flat");
}

}  // namespace
}  // namespace grouser
