// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/lbm/flow.hpp"

namespace grouser {
namespace {

// Open faces, moving observers and turning bodies against closed forms.

constexpr double kPi = std::numbers::pi;

void run(Flow& flow, int steps) {
  for (int i = 0; i < steps; ++i) flow.step();
}

FlowSettings flat_channel(std::int64_t length, std::int64_t width, double viscosity) {
  FlowSettings settings;
  settings.lattice = "D2Q9";
  settings.cells = {length, width, 1};
  settings.parameters.viscosity_lu = viscosity;
  for (Face& face : settings.faces[1]) face.kind = FaceKind::kWall;
  return settings;
}

// Momentum through the layer x.
double flux_now(const Flow& flow, std::int64_t x) {
  double sum = 0.0;
  for (std::int64_t y = 0; y < flow.blocks().cells()[1]; ++y) {
    const FlowNode node = flow.node(x, y, 0);
    sum += node.density_lu * node.velocity_lu.x;
  }
  return sum;
}

TEST(OpenFaces, PressuresDriveThePoiseuilleFlowOfTheirDifference) {
  // Between the last centres lie n - 1 cells. Density falls by 1e-5, which changes nothing else.
  const std::int64_t length = 24;
  const std::int64_t width = 11;
  const double viscosity = 0.15;
  const double fall = 1e-5;
  for (const int axis : {0, 1, 2}) {
    FlowSettings settings;
    const auto stream = static_cast<std::size_t>(axis);
    const std::size_t across = (stream + 1) % 3;
    settings.cells = {1, 1, 1};
    settings.cells[stream] = length;
    settings.cells[across] = width;
    settings.parameters.viscosity_lu = viscosity;
    for (Face& face : settings.faces[across]) face.kind = FaceKind::kWall;
    for (Face& face : settings.faces[stream]) face.kind = FaceKind::kPressure;
    settings.faces[stream][0].density_lu = 1.0 + 0.5 * fall;
    settings.faces[stream][1].density_lu = 1.0 - 0.5 * fall;
    const auto flow = make_flow(Communicator::alone(), settings);
    run(*flow, 20000);
    const double push = fall / 3.0 / static_cast<double>(length - 1);
    for (std::int64_t k = 0; k < width; ++k) {
      std::int64_t at[3] = {0, 0, 0};
      at[stream] = length / 2;
      at[across] = k;
      const FlowNode node = flow->node(at[0], at[1], at[2]);
      const double y = static_cast<double>(k) + 0.5;
      const double exact = push / (2.0 * viscosity) * y * (static_cast<double>(width) - y);
      const double u[3] = {node.velocity_lu.x, node.velocity_lu.y, node.velocity_lu.z};
      EXPECT_NEAR(u[stream] / exact, 1.0, 1e-3) << axis << " " << k;
      const double density = 1.0 + fall * (0.5 - static_cast<double>(length / 2) / 23.0);
      EXPECT_NEAR(node.density_lu, density, 1e-3 * fall);
    }
  }
}

TEST(OpenFaces, APlugBecomesAParabolaAndWhatGoesInComesOut) {
  const std::int64_t length = 120;
  const std::int64_t width = 20;
  const double speed = 0.03;
  FlowSettings settings = flat_channel(length, width, 0.06);  // Re 10
  settings.faces[0][0].kind = FaceKind::kVelocity;
  settings.faces[0][0].velocity_lu = {speed, 0.0, 0.0};
  settings.faces[0][1].kind = FaceKind::kPressure;
  const auto flow = make_flow(Communicator::alone(), settings);
  run(*flow, 30000);
  // Between x and x + 1, where what crosses is the mean of both; a sudden start leaves a momentum
  // near the pressure face that changes its sign from cell to cell and step to step for ever.
  const auto flux = [&](std::int64_t x) {
    return 0.5 * (flux_now(*flow, x) + flux_now(*flow, x + 1));
  };
  const double in = flux(1);
  for (const std::int64_t x : {40, 80, 110, 116}) EXPECT_NEAR(flux(x) / in, 1.0, 2e-3) << x;
  // Two widths from the outflow; the entrance takes about a width at this Reynolds number.
  const std::int64_t x = 80;
  for (std::int64_t y = 0; y < width; ++y) {
    const double share = (static_cast<double>(y) + 0.5) / static_cast<double>(width);
    const FlowNode node = flow->node(x, y, 0);
    const double mean = in / static_cast<double>(width) / node.density_lu;
    // A parabola's values at the centres have a mean of 1 + 1/(2 width^2).
    const double scale = 6.0 * mean / (1.0 + 0.5 / static_cast<double>(width * width));
    EXPECT_NEAR(node.velocity_lu.x, scale * share * (1.0 - share), 5e-4 * mean) << y;
  }
}

TEST(OpenFaces, AProfileIsWhatTheFluidOnTheFaceHas) {
  FlowSettings settings = flat_channel(10, 16, 0.1);
  settings.faces[0][0].kind = FaceKind::kVelocity;
  settings.faces[0][0].profile = [](const Vec3& p) {
    return Vec3{0.001 * (p.y + 0.5) * (15.5 - p.y), 0.0, 0.0};
  };
  settings.faces[0][1].kind = FaceKind::kPressure;
  const auto flow = make_flow(Communicator::alone(), settings);
  run(*flow, 3000);
  for (std::int64_t y = 0; y < 16; ++y) {
    const double wanted = settings.faces[0][0].profile({0.0, static_cast<double>(y), 0.0}).x;
    EXPECT_NEAR(flow->node(0, y, 0).velocity_lu.x, wanted, 1e-12);
    EXPECT_NEAR(flow->node(5, y, 0).velocity_lu.x, wanted, 0.01 * 0.064);
  }
}

TEST(OpenFaces, AVortexLeavesThroughTheOutflow) {
  // Carried out by a wind; what comes back are sound and the wake of the face.
  const double wind = 0.1;
  FlowSettings settings;
  settings.lattice = "D2Q9";
  settings.cells = {80, 60, 1};
  settings.parameters.viscosity_lu = 0.01;
  settings.faces[0][0].kind = FaceKind::kVelocity;
  settings.faces[0][0].velocity_lu = {wind, 0.0, 0.0};
  settings.faces[0][1].kind = FaceKind::kOutflow;
  const auto flow = make_flow(Communicator::alone(), settings);
  flow->set_equilibrium([&](const Vec3& p) {
    const double x = (p.x - 40.0) / 6.0;
    const double y = (p.y - 29.5) / 6.0;
    const double u = 0.02 * std::exp(0.5 - 0.5 * (x * x + y * y));
    return FlowNode{1.0 - 1.5 * u * u, {wind - u * y, u * x, 0.0}};
  });
  const auto unrest = [&] {
    double sum = 0.0;
    for (std::int64_t y = 0; y < 60; ++y)
      for (std::int64_t x = 0; x < 80; ++x)
        sum += norm2(flow->node(x, y, 0).velocity_lu - Vec3{wind, 0.0, 0.0});
    return sum;
  };
  const double before = unrest();
  run(*flow, 900);  // it is 90 cells further
  EXPECT_LT(unrest(), 0.03 * before);
}

// Decay rate of a shear wave along x with wave number k, over viscosity times k^2.
double decay(const char* lattice, const char* collision, const Vec3& wind) {
  const std::int64_t cells = 40;
  const double k = 2.0 * kPi / static_cast<double>(cells);
  FlowSettings settings;
  settings.lattice = lattice;
  settings.collision = collision;
  settings.cells = {cells, 1, 1};
  settings.parameters.viscosity_lu = 0.05;
  const auto flow = make_flow(Communicator::alone(), settings);
  flow->set_equilibrium([&](const Vec3& p) {
    return FlowNode{1.0, wind + Vec3{0.0, 1e-4 * std::sin(k * p.x), 0.0}};
  });
  const auto size = [&] {
    double sine = 0.0;
    double cosine = 0.0;
    for (std::int64_t x = 0; x < cells; ++x) {
      const double u = flow->node(x, 0, 0).velocity_lu.y - wind.y;
      sine += u * std::sin(k * static_cast<double>(x));
      cosine += u * std::cos(k * static_cast<double>(x));
    }
    return std::hypot(sine, cosine);
  };
  run(*flow, 100);
  const double before = size();
  run(*flow, 400);
  return std::log(before / size()) / (400.0 * 0.05 * k * k);
}

TEST(GalileanShift, ChangesViscosityAsTheQuadraticEquilibriumPredicts) {
  // Wind along the wave vector: viscosity x (1 - 3 U^2); across it: none.
  // Source: Qian, Zhou 1998, Europhys. Lett. 42, 359.
  for (const char* lattice : {"D2Q9", "D3Q19", "D3Q27"})
    for (const char* collision : {"bgk", "trt", "mrt"}) {
      const double still = decay(lattice, collision, {});
      EXPECT_NEAR(still, 1.0, 2e-3) << lattice << collision;
      EXPECT_NEAR(decay(lattice, collision, {0.0, 0.15, 0.0}), still, 6e-4);  // (k U)^2
      for (const double wind : {0.05, 0.15})
        EXPECT_NEAR((decay(lattice, collision, {wind, 0.0, 0.0}) - still) / (-3.0 * wind * wind),
                    1.0, 0.15)
            << lattice << collision << wind;
    }
}

TEST(GalileanShift, WallsFeelTheSameForceForAMovingObserver) {
  // Poiseuille flow between walls that move along it as fast as the fluid would be seen to.
  const auto loads = [](double wind) {
    FlowSettings settings;
    settings.cells = {1, 9, 1};
    settings.parameters.viscosity_lu = 0.2;
    settings.force_lu = {1e-5, 0.0, 0.0};
    for (Face& face : settings.faces[1]) {
      face.kind = FaceKind::kWall;
      face.velocity_lu = {wind, 0.0, 0.5 * wind};
    }
    const auto flow = make_flow(Communicator::alone(), settings);
    flow->set_equilibrium([&](const Vec3&) { return FlowNode{1.0, {wind, 0.0, 0.5 * wind}}; });
    run(*flow, 4000);
    return flow->loads();
  };
  const auto still = loads(0.0);
  const auto moving = loads(0.1);
  for (std::size_t wall : {2u, 3u}) {
    EXPECT_NEAR(still[wall].force_lu.x, 4.5e-5, 1e-12);
    EXPECT_NEAR(moving[wall].force_lu.x, still[wall].force_lu.x, 1e-9);
    EXPECT_NEAR(moving[wall].force_lu.z, 0.0, 1e-9);
  }
}

// A cylinder that turns within a still one. @return torque over theory's, and the velocity's error
// over its size, root mean squares over the fluid
std::pair<double, double> turning_cylinders(double inner, bool interpolated) {
  const double outer = 2.2 * inner;
  const double spin = 0.01 / inner;
  const double viscosity = 0.1;
  const auto cells = static_cast<std::int64_t>(2.0 * outer) + 6;
  const double middle = 0.5 * static_cast<double>(cells - 1);
  FlowSettings settings;
  settings.lattice = "D2Q9";
  settings.cells = {cells, cells, 1};
  settings.parameters.viscosity_lu = viscosity;
  const auto distance = [=](const Vec3& p) { return std::hypot(p.x - middle, p.y - middle); };
  Obstacle rod{[=](const Vec3& p) { return distance(p) - inner; }};
  rod.interpolated = interpolated;
  rod.centre = {middle, middle, 0.0};
  rod.spin_lu = {0.0, 0.0, spin};
  Obstacle shell{[=](const Vec3& p) { return outer - distance(p); }};
  shell.interpolated = interpolated;
  shell.centre = rod.centre;
  settings.obstacles = {rod, shell};
  const auto flow = make_flow(Communicator::alone(), settings);
  run(*flow, static_cast<int>(1.5 * (outer - inner) * (outer - inner) / viscosity));
  const double a2 = inner * inner;
  const double b2 = outer * outer;
  const double torque = -4.0 * kPi * viscosity * spin * a2 * b2 / (b2 - a2);
  double error2 = 0.0;
  double size2 = 0.0;
  for (std::int64_t y = 0; y < cells; ++y)
    for (std::int64_t x = 0; x < cells; ++x) {
      if (!flow->is_fluid(x, y, 0)) continue;
      const Vec3 p{static_cast<double>(x), static_cast<double>(y), 0.0};
      const double r = distance(p);
      const double exact = spin * a2 / (b2 - a2) * (b2 / r - r);
      error2 += std::pow(norm(flow->node(x, y, 0).velocity_lu) - exact, 2);
      size2 += exact * exact;
    }
  return {flow->loads()[0].moment_lu.z / torque, std::sqrt(error2 / size2)};
}

// The mean over places of the surface between centres.
double mean_error(double scale, bool interpolated) {
  double sum = 0.0;
  for (const double inner : {5.0, 5.2, 5.4, 5.6, 5.8})
    sum += 0.2 * turning_cylinders(scale * inner, interpolated).second;
  return sum;
}

TEST(TurningCylinder, FeelsTheTorqueOfTheory) {
  // Source: Couette 1890: torque per length 4 pi mu Omega a^2 b^2 / (b^2 - a^2). The half-way
  // surface lies anywhere within half a cell of where it should.
  for (const double inner : {5.0, 5.2, 5.4, 5.6, 5.8}) {
    EXPECT_NEAR(turning_cylinders(inner, false).first, 1.0, 0.1) << inner;
    EXPECT_NEAR(turning_cylinders(inner, true).first, 1.0, 0.011) << inner;
  }
}

TEST(TurningCylinder, InterpolatedSurfacesConvergeWithTheSquareOfTheCellHalfWayOnesWithTheCell) {
  EXPECT_NEAR(std::log2(mean_error(1.0, true) / mean_error(4.0, true)) / 2.0, 2.0, 0.3);
  EXPECT_NEAR(std::log2(mean_error(1.0, false) / mean_error(4.0, false)) / 2.0, 1.0, 0.4);
}

TEST(SquareDuct, HasTheFlowOfTheSeries) {
  // Mean velocity = 0.0351443 side^2 force / viscosity (Boussinesq 1868).
  const auto error = [](std::int64_t side) {
    FlowSettings settings;
    settings.cells = {1, side, side};
    settings.parameters.viscosity_lu = 0.2;
    settings.force_lu = {1e-6, 0.0, 0.0};
    for (std::size_t axis : {1u, 2u})
      for (Face& face : settings.faces[axis]) face.kind = FaceKind::kWall;
    const auto flow = make_flow(Communicator::alone(), settings);
    run(*flow, static_cast<int>(6.0 * static_cast<double>(side * side)));
    const auto cells = static_cast<double>(side * side);
    const double mean = flow->totals().momentum_lu.x / cells;
    return std::abs(mean / (0.0351443 * cells * 1e-6 / 0.2) - 1.0);
  };
  const double coarse = error(8);
  const double fine = error(16);
  EXPECT_LT(fine, 0.01);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.2);
}

}  // namespace
}  // namespace grouser
