// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/random.hpp"
#include "engine/lbm/ball_cover.hpp"
#include "engine/lbm/body_cover.hpp"
#include "engine/lbm/flow.hpp"

namespace grouser {
namespace {

constexpr double kPi = std::numbers::pi;

double volume_of(double radius) { return 4.0 / 3.0 * kPi * radius * radius * radius; }

// Fractions of the cells of one row from x = 0 on.
std::vector<float> row_of(const Vec3& centre, double radius, double y, double z) {
  std::vector<float> fractions(64);
  BallRow{centre.x, y - centre.y, z - centre.z, cover_radius(radius)}.cover(
      0, static_cast<std::int64_t>(fractions.size()), fractions.data());
  return fractions;
}

// By counting points of a cell that lie inside.
double counted(const Vec3& centre, double radius, const Vec3& cell) {
  constexpr int kPoints = 20;
  int inside = 0;
  for (int i = 0; i < kPoints * kPoints * kPoints; ++i) {
    const auto at = [](int k) { return (k + 0.5) / kPoints - 0.5; };
    const Vec3 point =
        cell + Vec3{at(i % kPoints), at(i / kPoints % kPoints), at(i / kPoints / kPoints)};
    if (norm2(point - centre) < radius * radius) ++inside;
  }
  return static_cast<double>(inside) / (kPoints * kPoints * kPoints);
}

TEST(BallCover, FractionsAreThoseOfCountedPoints) {
  // Curvature within a cell is left out but for its mean: an error of some 1/(24 R); counting adds
  // up to 1/40 where the surface is along an axis.
  for (const double radius : {3.0, 5.0, 12.0}) {
    double worst = 0.0;
    double sum2 = 0.0;
    int cut = 0;
    for (std::uint64_t k = 0; k < 6; ++k) {
      const Vec3 centre{16.0 + random_unit(1, k, 0), 16.0 + random_unit(1, k, 1),
                        16.0 + random_unit(1, k, 2)};
      for (int z = 0; z < 32; z += 2)
        for (int y = 0; y < 32; ++y) {
          const std::vector<float> row = row_of(centre, radius, y, z);
          for (int x = 0; x < 32; ++x) {
            const double found = static_cast<double>(row[static_cast<std::size_t>(x)]);
            const Vec3 cell{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
            const double off = norm(cell - centre) - radius;
            if (std::abs(off) > 0.9) {
              ASSERT_EQ(found, off < 0.0 ? 1.0 : 0.0);
              continue;
            }
            const double error = found - counted(centre, radius, cell);
            worst = std::max(worst, std::abs(error));
            sum2 += error * error;
            ++cut;
          }
        }
    }
    EXPECT_LT(worst, 0.02 + 0.1 / radius) << radius;
    EXPECT_LT(std::sqrt(sum2 / cut), 0.006 + 0.02 / radius) << radius;
  }
}

TEST(BallCover, FractionsAddUpToTheVolume) {
  for (const double radius : {2.0, 4.0, 8.0}) {
    double sum = 0.0;
    constexpr int kPlaces = 40;
    for (std::uint64_t k = 0; k < kPlaces; ++k) {
      const Vec3 centre{16.0 + random_unit(2, k, 0), 16.0 + random_unit(2, k, 1),
                        16.0 + random_unit(2, k, 2)};
      double one = 0.0;
      for (int z = 0; z < 32; ++z)
        for (int y = 0; y < 32; ++y)
          for (const float e : row_of(centre, radius, y, z)) one += static_cast<double>(e);
      // One place is off by chance: cells at the surface by some hundredth each, in no order.
      EXPECT_NEAR(one / volume_of(radius), 1.0, 0.02 / radius);
      sum += one;
    }
    EXPECT_NEAR(sum / kPlaces / volume_of(radius), 1.0, 0.002);
  }
}

// A box from `low` to `high`, facets outward.
ImmersedBody box_body(const Vec3& low, const Vec3& high) {
  ImmersedBody body;
  for (int k = 0; k < 8; ++k)
    body.corners.push_back({(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                            (k & 4) != 0 ? high.z : low.z});
  body.facets = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  body.centre = 0.5 * (low + high);
  return body;
}

TEST(BodyCover, FractionsOfABoxAreProductsOfItsOverlaps) {
  const Vec3 low{3.2, 2.9, 4.4};
  const Vec3 high{8.7, 9.1, 7.3};
  const ImmersedBody body = box_body(low, high);
  const BodyCover cover(body.corners, body.facets, {0, 16, 0, 16});
  const auto part = [](double from, double to, double cell) {
    return std::max(0.0, std::min(to, cell + 0.5) - std::max(from, cell - 0.5));
  };
  float row[16];
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y) {
      cover.cover(y, z, 0, 16, row);
      for (int x = 0; x < 16; ++x) {
        const double exact =
            part(low.x, high.x, x) * part(low.y, high.y, y) * part(low.z, high.z, z);
        // Exact along x, an eighth of a cell across at each side.
        EXPECT_NEAR(static_cast<double>(row[x]), exact, 0.25) << x << ' ' << y << ' ' << z;
        const auto [begin, end] = cover.reach(y, z);
        if (x < begin || x >= end) {
          EXPECT_EQ(row[x], 0.0F);
        }
      }
    }
  // Where only x cuts nothing is off.
  cover.cover(6, 6, 0, 16, row);
  EXPECT_NEAR(static_cast<double>(row[3]), 0.3, 1e-6);
  EXPECT_NEAR(static_cast<double>(row[9]), 0.2, 1e-6);
  EXPECT_EQ(row[6], 1.0F);
}

FlowSettings cube(std::int64_t cells, double viscosity, const char* lattice = "D3Q19") {
  FlowSettings s;
  s.lattice = lattice;
  s.cells = {cells, cells, cells};
  s.parameters.viscosity_lu = viscosity;
  return s;
}

Vec3 force_on(const Flow& flow, std::size_t ball = 0) {
  return flow.immersed_loads().at(ball).force_lu();
}
Vec3 moment_on(const Flow& flow, std::size_t ball = 0) {
  return flow.immersed_loads().at(ball).moment_lu();
}

std::unique_ptr<Flow> stirred(const FlowSettings& settings, const Communicator& ranks) {
  auto flow = make_flow(ranks, settings);
  flow->set_equilibrium([](const Vec3& p) {
    return FlowNode{1.0 + 0.01 * std::sin(0.7 * p.x),
                    {0.02 * std::sin(0.9 * p.y), 0.01 * std::cos(0.4 * p.z), 0.02 * p.x / 16.0}};
  });
  return flow;
}

// Overlapping, across the ends, turning.
std::vector<ImmersedBall> three_balls(double time) {
  return {{{0.3 + 0.02 * time, 3.1, 4.2}, 2.6, {0.02, 0.01, -0.01}, {0.001, 0.002, -0.003}},
          {{4.4, 4.0, 4.9}, 2.9, {-0.01, 0.0, 0.02}, {0.0, -0.004, 0.001}},
          {{8.2, 8.3 - 0.01 * time, 11.8}, 3.2, {0.0, -0.01, 0.0}, {}}};
}

TEST(Immersed, MomentumOfFluidAndSolidsIsKeptToRounding) {
  for (const char* lattice : {"D3Q15", "D3Q19", "D3Q27"})
    for (const char* collision : {"bgk", "trt", "mrt", "les"}) {
      FlowSettings settings = cube(16, 0.05, lattice);
      settings.collision = collision;
      settings.parameters.smagorinsky = 0.1;
      settings.force_lu = {1e-5, -2e-5, 3e-5};
      const auto flow = stirred(settings, Communicator::alone());
      const FlowTotals before = flow->totals();
      Vec3 given{};
      constexpr int kSteps = 25;
      for (int step = 0; step < kSteps; ++step) {
        flow->immerse(three_balls(step));
        flow->step();
        for (std::size_t b = 0; b < 3; ++b) given += force_on(*flow, b);
      }
      const FlowTotals after = flow->totals();
      const Vec3 left = after.momentum_lu - before.momentum_lu -
                        (kSteps * before.cells) * settings.force_lu + given;
      EXPECT_GT(norm(given), 0.1);
      // 4096 cells, 25 steps, populations of some 0.1: 1e-16 each, in no order.
      EXPECT_LT(norm(left), 1e-12) << lattice << ' ' << collision;
      EXPECT_NEAR(after.excess_lu, before.excess_lu, 1e-12);
    }
}

TEST(Immersed, MomentumOfFluidAndABodyIsKeptToRounding) {
  const auto flow = stirred(cube(16, 0.05), Communicator::alone());
  const Vec3 before = flow->totals().momentum_lu;
  Vec3 given{};
  for (int step = 0; step < 20; ++step) {
    const double way = 0.02 * step;
    ImmersedBody body = box_body({3.2 + way, 2.9, 4.4}, {8.7 + way, 9.1, 7.3});
    body.velocity = {0.02, 0.0, 0.0};
    body.spin = {0.001, 0.002, 0.0};
    flow->immerse(three_balls(step), {body});
    flow->step();
    for (std::size_t b = 0; b < 4; ++b) given += force_on(*flow, b);
  }
  EXPECT_GT(norm(force_on(*flow, 3)), 1e-3);
  // As above.
  EXPECT_LT(norm(flow->totals().momentum_lu - before + given), 1e-12);
}

TEST(Immersed, SolidsThatAreNotThereChangeNoBit) {
  FlowSettings settings = cube(16, 0.05);
  const auto plain = stirred(settings, Communicator::alone());
  const auto beside = stirred(settings, Communicator::alone());
  // Its register's cells are mixed with a weight of 0.
  beside->immerse({{{8.5, 8.5, 8.5}, 1e-3, {0.1, 0.1, 0.1}, {}}});
  plain->step();
  beside->step();
  for (std::int64_t z = 0; z < 16; ++z)
    for (std::int64_t y = 0; y < 16; ++y)
      for (std::int64_t x = 0; x < 16; ++x) {
        if (std::abs(x - 8) < 3 && std::abs(y - 8) < 3 && std::abs(z - 8) < 3) continue;
        for (std::size_t i = 0; i < 19; ++i)
          ASSERT_EQ(plain->population(i, x, y, z), beside->population(i, x, y, z));
      }
}

TEST(Immersed, FluidPushesASolidTheWayItFlows) {
  const auto flow = make_flow(Communicator::alone(), cube(24, 0.1));
  flow->set_equilibrium([](const Vec3&) { return FlowNode{1.0, {0.01, 0.0, 0.0}}; });
  flow->immerse({{{12.0, 12.0, 12.0}, 4.0, {}, {}}});
  for (int step = 0; step < 50; ++step) flow->step();
  EXPECT_GT(force_on(*flow).x, 0.0);
  // Symmetric but for rounding.
  EXPECT_NEAR(force_on(*flow).y, 0.0, 1e-6 * force_on(*flow).x);
  EXPECT_NEAR(norm(moment_on(*flow)), 0.0, 1e-6 * force_on(*flow).x);
}

// The ball that stands for a grain of this radius.
double immersed_radius(double radius, double viscosity) {
  return radius + immersed_excess(radius, viscosity, CollisionParameters{}.magic);
}

// Drag of a simple cubic array of spheres over 6 pi mu R U, U the mean velocity over the whole
// volume.
double array_drag(std::int64_t cells, double radius, double viscosity, const Vec3& off) {
  FlowSettings settings = cube(cells, viscosity);
  const auto side = static_cast<double>(cells);
  const double volume = side * side * side;
  const double push = 1e-6 * viscosity;
  settings.force_lu = {push, 0.0, 0.0};
  const auto flow = make_flow(Communicator::alone(), settings);
  const Vec3 middle{0.5 * side, 0.5 * side, 0.5 * side};
  flow->immerse({{middle + off, immersed_radius(radius, viscosity), {}, {}}});
  double speed = 0.0;
  for (int round = 0; round < 300; ++round) {
    for (int step = 0; step < 100; ++step) flow->step();
    const double now = flow->totals().momentum_lu.x / volume;
    const bool steady = std::abs(now - speed) < 1e-4 * now;
    speed = now;
    if (steady) break;
  }
  // What drives the fluid is held by the sphere.
  EXPECT_NEAR(force_on(*flow).x / (push * volume), 1.0, 2e-3);
  return force_on(*flow).x / (6.0 * kPi * viscosity * radius * speed);
}

double array_radius(double side, double fraction) {
  return side * std::cbrt(0.75 * fraction / kPi);
}

TEST(Immersed, DragOfACubicArrayIsThatOfZickAndHomsy) {
  // Zick, Homsy 1982, table 2. Spheres of 7.4 cells; 3 % is what the calibration leaves.
  EXPECT_NEAR(array_drag(15, array_radius(15.0, 0.064), 1.0 / 6.0, {}), 2.810, 0.03 * 2.810);
  EXPECT_NEAR(array_drag(15, array_radius(15.0, 0.064), 0.05, {}), 2.810, 0.03 * 2.810);
  // A fraction that the calibration has not seen, and 9 cells; walls are 3 cells apart.
  EXPECT_NEAR(array_drag(12, array_radius(12.0, 0.216), 0.05, {}), 7.442, 0.05 * 7.442);
}

TEST(Immersed, DragDependsLittleOnThePlaceBetweenCentres) {
  const double radius = array_radius(15.0, 0.064);
  const double one = array_drag(15, radius, 1.0 / 6.0, {});
  for (const Vec3& off : {Vec3{0.31, 0.47, 0.18}, Vec3{0.5, 0.5, 0.5}, Vec3{0.0, 0.25, 0.0}})
    EXPECT_NEAR(array_drag(15, radius, 1.0 / 6.0, off) / one, 1.0, 0.01);
}

TEST(Immersed, ATurningSphereFeelsItsTorque) {
  // 8 pi mu R^3 Omega in unbounded fluid; images that turn along, in a volume without mean
  // vorticity, raise it by the fraction of the volume. The radius is calibrated on drag: some
  // 0.04 cells too large for a torque, 2 % of R^3.
  const double radius = 6.0;
  const double cells = 40.0;
  const double viscosity = 1.0 / 6.0;
  const double spin = 1e-4;
  const auto flow = make_flow(Communicator::alone(), cube(40, viscosity));
  const Vec3 axis = (1.0 / std::sqrt(14.0)) * Vec3{1.0, 2.0, 3.0};
  flow->immerse({{{20.2, 19.9, 20.4}, immersed_radius(radius, viscosity), {}, spin * axis}});
  for (int step = 0; step < 1200; ++step) flow->step();
  const Vec3 moment = moment_on(*flow);
  const double fraction = volume_of(radius) / (cells * cells * cells);
  const double expected = -8.0 * kPi * viscosity * std::pow(radius, 3) * spin / (1.0 - fraction);
  EXPECT_NEAR(dot(moment, axis) / expected, 1.0, 0.03);
  EXPECT_LT(norm(moment - dot(moment, axis) * axis), 0.01 * norm(moment));
}

TEST(Immersed, DragDoesNotDependOnTheObserver) {
  // A ball through fluid at rest against fluid past a ball at rest: errors of the quadratic
  // equilibrium are of u^2 = 1e-4, fractions that change on the way some thousandths.
  const double speed = 0.01;
  const auto run = [&](double ball_speed, double fluid_speed) {
    const auto flow = make_flow(Communicator::alone(), cube(32, 0.1));
    flow->set_equilibrium([&](const Vec3&) { return FlowNode{1.0, {fluid_speed, 0.0, 0.0}}; });
    double sum = 0.0;
    for (int step = 0; step < 500; ++step) {
      flow->immerse({{{16.0 + ball_speed * step, 16.0, 16.0}, 5.0, {ball_speed, 0.0, 0.0}, {}}});
      flow->step();
      if (step >= 300) sum += force_on(*flow).x / 200.0;
    }
    return sum;
  };
  const double still = run(0.0, speed);
  EXPECT_GT(still, 0.0);
  EXPECT_NEAR(run(-speed, 0.0), still, 0.01 * still);
  EXPECT_NEAR(run(speed, 2.0 * speed), still, 0.01 * still);
}

}  // namespace
}  // namespace grouser
