// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/random.hpp"
#include "engine/lbm/flow.hpp"

namespace grouser {
namespace {

constexpr double kPi = std::numbers::pi;

void run(Flow& flow, int steps) {
  for (int i = 0; i < steps; ++i) flow.step();
}

void walls(FlowSettings& settings, std::size_t axis) {
  for (Face& face : settings.faces[axis]) face.kind = FaceKind::kWall;
}

double component(const Vec3& v, std::size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}
Vec3 along(std::size_t axis, double value) {
  return {axis == 0 ? value : 0.0, axis == 1 ? value : 0.0, axis == 2 ? value : 0.0};
}

// Vortices that decay with time in the plane of two axes, moved along by a steady wind: an exact
// solution of the Navier-Stokes equations.
struct Vortices {
  double cells;  // of one period
  double speed;  // cells per step
  double viscosity;
  std::size_t a, b;
  Vec3 wind{};

  FlowNode at(const Vec3& place, double time) const {
    const double k = 2.0 * kPi / cells;
    const double x = k * (component(place, a) - component(wind, a) * time);
    const double y = k * (component(place, b) - component(wind, b) * time);
    const double left = std::exp(-2.0 * viscosity * k * k * time);
    const double u = speed * left;
    FlowNode node;
    node.velocity_lu =
        wind + along(a, -u * std::cos(x) * std::sin(y)) + along(b, u * std::sin(x) * std::cos(y));
    node.density_lu = 1.0 - 3.0 * u * u / 4.0 * (std::cos(2.0 * x) + std::cos(2.0 * y));
    return node;
  }
};

// Error of the velocity after the vortices have lost a factor e, relative to their speed then.
double vortex_error(const FlowSettings& base, std::int64_t cells, std::size_t a, std::size_t b,
                    double speed, const Vec3& wind = {}) {
  FlowSettings settings = base;
  settings.cells = {1, 1, 1};
  settings.cells[a] = settings.cells[b] = cells;
  const Vortices exact{static_cast<double>(cells), speed, base.parameters.viscosity_lu, a, b, wind};
  const auto flow = make_flow(Communicator::alone(), settings);
  flow->set_equilibrium([&](const Vec3& place) { return exact.at(place, 0.0); });
  const double k = 2.0 * kPi / static_cast<double>(cells);
  const int steps = static_cast<int>(1.0 / (2.0 * exact.viscosity * k * k));
  run(*flow, steps);
  double error2 = 0.0;
  double size2 = 0.0;
  for (std::int64_t z = 0; z < settings.cells[2]; ++z)
    for (std::int64_t y = 0; y < settings.cells[1]; ++y)
      for (std::int64_t x = 0; x < settings.cells[0]; ++x) {
        const Vec3 place{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        const Vec3 wanted = exact.at(place, steps).velocity_lu - wind;
        error2 += norm2(flow->node(x, y, z).velocity_lu - wind - wanted);
        size2 += norm2(wanted);
      }
  return std::sqrt(error2 / size2);
}

TEST(TaylorGreen, ConvergesWithTheSquareOfTheCellOnEveryLattice) {
  // Speed falls as the cell does (diffusive scaling), so that errors of compressibility, of the
  // second order in the Mach number, fall as fast.
  for (const char* lattice : kLattices)
    for (const char* collision : {"bgk", "trt", "mrt"})
      for (const auto& [a, b] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{2, 0}}) {
        if (std::string(lattice) == "D2Q9" && b != 1) continue;
        FlowSettings settings;
        settings.lattice = lattice;
        settings.collision = collision;
        settings.parameters.viscosity_lu = 0.08;
        const auto error = [&](std::int64_t cells) {
          return vortex_error(settings, cells, static_cast<std::size_t>(a),
                              static_cast<std::size_t>(b), 0.4 / static_cast<double>(cells));
        };
        const double coarse = error(16);
        const double fine = error(32);
        const double order = std::log2(coarse / fine);
        EXPECT_NEAR(order, 2.0, 0.1) << lattice << " " << collision << " plane " << a << b;
        EXPECT_LT(fine, 0.01);
      }
}

TEST(TaylorGreen, WindChangesTheDecayByTheSquareOfItsMachNumberOnly) {
  // The equilibrium lacks cubic terms: viscosity is off by a few U^2 in units of cells and steps.
  FlowSettings settings;
  settings.lattice = "D2Q9";
  settings.parameters.viscosity_lu = 0.05;
  const double still = vortex_error(settings, 32, 0, 1, 0.01);
  const double slow = vortex_error(settings, 32, 0, 1, 0.01, {0.05, 0.0, 0.0});
  const double fast = vortex_error(settings, 32, 0, 1, 0.01, {0.1, 0.0, 0.0});
  EXPECT_LT(slow, still + 4.0 * 0.05 * 0.05);
  EXPECT_LT(fast, still + 4.0 * 0.1 * 0.1);
}

TEST(TaylorGreen, SinglePrecisionGivesTheSameFlow) {
  FlowSettings settings;
  settings.parameters.viscosity_lu = 0.05;
  const double in_double = vortex_error(settings, 24, 0, 1, 0.02);
  settings.precision = Precision::kSingle;
  const double in_single = vortex_error(settings, 24, 0, 1, 0.02);
  // Some hundred steps, each rounding a deviation to 6e-8 of itself.
  EXPECT_NEAR(in_single, in_double, 1e-4 * in_double + 1e-5);
}

// Steady velocity along `stream` across a channel between two ends of `across`.
std::vector<double> channel(FlowSettings settings, std::size_t stream, std::size_t across,
                            std::int64_t width, double viscosity, std::unique_ptr<Flow>* out) {
  settings.parameters.viscosity_lu = viscosity;
  settings.cells = {1, 1, 1};
  settings.cells[across] = width;
  auto flow = make_flow(Communicator::alone(), settings);
  // The slowest mode falls by e in (2 width / pi)^2 / viscosity where one side slips.
  const double time = std::pow(2.0 * static_cast<double>(width) / kPi, 2) / viscosity;
  run(*flow, static_cast<int>(36.0 * time));
  std::vector<double> profile;
  for (std::int64_t k = 0; k < width; ++k) {
    std::int64_t at[3] = {0, 0, 0};
    at[across] = k;
    profile.push_back(component(flow->node(at[0], at[1], at[2]).velocity_lu, stream));
  }
  if (out != nullptr) *out = std::move(flow);
  return profile;
}

TEST(Poiseuille, IsExactWhenTheMagicNumberPutsWallsHalfWay) {
  const double force = 1e-5;
  for (const char* lattice : kLattices)
    for (const auto& [stream, across] : {std::pair{0u, 1u}, std::pair{1u, 2u}, std::pair{2u, 0u}}) {
      if (std::string(lattice) == "D2Q9" && stream != 0) continue;
      FlowSettings settings;
      settings.lattice = lattice;
      settings.force_lu = along(stream, force);
      walls(settings, across);
      const std::int64_t width = 9;
      for (const double viscosity : {0.05, 0.7}) {
        const auto profile = channel(settings, stream, across, width, viscosity, nullptr);
        const auto h = static_cast<double>(width);
        for (std::size_t k = 0; k < profile.size(); ++k) {
          const double y = static_cast<double>(k) + 0.5;
          const double exact = force / (2.0 * viscosity) * y * (h - y);
          // Not steady to the last bit: e^-36 of the start is left.
          EXPECT_NEAR(profile[k], exact, 1e-10 * force * h * h / viscosity)
              << lattice << " cell " << k << " viscosity " << viscosity;
        }
      }
    }
}

TEST(Poiseuille, BgkPutsWallsElsewhereAtLargeViscosity) {
  // What TRT mends. BGK's magic number is viscosity^2 x 9; the slip is of the second order.
  FlowSettings settings;
  settings.lattice = "D2Q9";
  settings.collision = "bgk";
  settings.force_lu = {1e-5, 0.0, 0.0};
  walls(settings, 1);
  const auto profile = channel(settings, 0, 1, 9, 0.7, nullptr);
  const double exact = 1e-5 / 1.4 * 4.5 * 4.5;
  // Source: He, Zou, Luo, Dembo 1997: u_slip = F/(2 nu) x 4/3 (magic - 3/16).
  const double slip = 1e-5 / 1.4 * 4.0 / 3.0 * (9.0 * 0.7 * 0.7 - 3.0 / 16.0);
  EXPECT_NEAR(profile[4], exact + slip, 1e-9 * exact);
}

TEST(Poiseuille, ASlipFaceIsTheMiddleOfAChannelTwiceAsWide) {
  for (const auto& [stream, across] : {std::pair{0u, 1u}, std::pair{1u, 2u}, std::pair{2u, 0u}}) {
    FlowSettings settings;
    settings.force_lu = along(stream, 1e-5);
    settings.faces[across][0].kind = FaceKind::kWall;
    settings.faces[across][1].kind = FaceKind::kSlip;
    const auto half = channel(settings, stream, across, 5, 0.3, nullptr);
    settings.faces[across][1].kind = FaceKind::kWall;
    const auto whole = channel(settings, stream, across, 10, 0.3, nullptr);
    for (std::size_t k = 0; k < half.size(); ++k) EXPECT_NEAR(half[k], whole[k], 1e-9 * whole[4]);
  }
}

TEST(Couette, IsLinearAndTheWallsFeelTheShear) {
  const double speed = 0.02;
  const double viscosity = 0.2;
  const std::int64_t width = 8;
  for (const char* lattice : kLattices)
    for (const auto& [stream, across] : {std::pair{0u, 1u}, std::pair{1u, 2u}, std::pair{2u, 0u}}) {
      if (std::string(lattice) == "D2Q9" && stream != 0) continue;
      FlowSettings settings;
      settings.lattice = lattice;
      walls(settings, across);
      settings.faces[across][1].velocity_lu = along(stream, speed);
      std::unique_ptr<Flow> flow;
      const auto profile = channel(settings, stream, across, width, viscosity, &flow);
      const auto h = static_cast<double>(width);
      for (std::size_t k = 0; k < profile.size(); ++k)
        EXPECT_NEAR(profile[k], speed * (static_cast<double>(k) + 0.5) / h, 1e-12);
      // One cell wide along the flow: force per unit area is density x viscosity x shear rate.
      const auto loads = flow->loads();
      const double stress = viscosity * speed / h;
      EXPECT_NEAR(component(loads[2 * across].force_lu, stream), stress, 1e-8 * stress);
      EXPECT_NEAR(component(loads[2 * across + 1].force_lu, stream), -stress, 1e-8 * stress);
    }
}

TEST(Conservation, MassStaysAndMomentumGrowsByTheForceToRounding) {
  for (const char* lattice : kLattices)
    for (const char* collision : kCollisions) {
      FlowSettings settings;
      settings.lattice = lattice;
      settings.collision = collision;
      settings.parameters.viscosity_lu = 0.02;
      settings.parameters.smagorinsky = 0.15;
      settings.cells = {13, 6, std::string(lattice) == "D2Q9" ? 1 : 5};
      settings.force_lu = {2e-5, -1e-5, std::string(lattice) == "D2Q9" ? 0.0 : 3e-5};
      const auto flow = make_flow(Communicator::alone(), settings);
      std::uint64_t draws = 0;
      const auto draw = [&] { return random_unit(3, 1, draws++) - 0.5; };
      const bool flat = settings.cells[2] == 1;
      flow->set_equilibrium([&](const Vec3&) {
        return FlowNode{1.0 + 0.1 * draw(),
                        {0.1 * draw(), 0.1 * draw(), flat ? 0.0 : 0.1 * draw()}};
      });
      const FlowTotals before = flow->totals();
      const int steps = 101;
      run(*flow, steps);
      const FlowTotals after = flow->totals();
      const double cells = before.cells;
      // A cell rounds a population of 0.02 by 3e-18 in each of some twenty sums a step; the walk of
      // them all is far below their sum.
      const double rounding = 1e-16 * cells * steps;
      EXPECT_NEAR(after.excess_lu, before.excess_lu, rounding) << lattice << collision;
      const Vec3 grown = before.momentum_lu + (cells * steps) * settings.force_lu;
      EXPECT_NEAR(after.momentum_lu.x, grown.x, rounding) << lattice << collision;
      EXPECT_NEAR(after.momentum_lu.y, grown.y, rounding);
      EXPECT_NEAR(after.momentum_lu.z, grown.z, rounding);
    }
}

TEST(LargeEddies, AddTheViscosityOfSmagorinskyInASteadyShear) {
  // Couette flow has one shear rate everywhere: stress on the wall = (nu + C^2 |S|) S, |S| = S.
  FlowSettings settings;
  settings.collision = "les";
  settings.parameters.smagorinsky = 0.3;
  walls(settings, 1);
  settings.faces[1][1].velocity_lu = {0.1, 0.0, 0.0};
  std::unique_ptr<Flow> flow;
  channel(settings, 0, 1, 8, 0.01, &flow);
  const double shear = 0.1 / 8.0;
  const double stress = (0.01 + 0.09 * shear) * shear;
  EXPECT_NEAR(flow->loads()[2].force_lu.x, stress, 0.02 * stress);  // wall layer: half-way links
  EXPECT_GT(flow->loads()[2].force_lu.x, 1.05 * 0.01 * shear);
}

}  // namespace
}  // namespace grouser
