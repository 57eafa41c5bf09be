// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/random.hpp"
#include "engine/coupling/unresolved_flow.hpp"

namespace grouser {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFixed = 1e30;  // [kg]
const Fluid kWater{1000.0, 1e-3};
const Fluid kSyrup{1200.0, 1.0};

double volume_of(const GrainInFlow& g) { return 4.0 / 3.0 * kPi * std::pow(g.radius, 3); }

UnresolvedSettings settings_of(const Fluid& fluid, const CellCounts& cells, double cell,
                               double time_step) {
  UnresolvedSettings s;
  s.lattice.cells = cells;
  s.cell = cell;
  s.time_step = time_step;
  s.fluid = fluid;
  return s;
}

std::vector<GrainInFlow> random_grains(int count, double radius, double mass, const Vec3& size,
                                       double speed) {
  std::vector<GrainInFlow> grains;
  std::uint64_t draws = 0;
  const auto draw = [&] { return random_unit(11, 2, draws++); };
  for (int i = 0; i < count; ++i) {
    GrainInFlow g;
    g.id = i;
    g.position = {size.x * draw(), size.y * draw(), size.z * draw()};
    g.velocity = speed * Vec3{draw() - 0.5, draw() - 0.5, draw() - 0.5};
    g.radius = radius;
    g.mass = mass;
    grains.push_back(g);
  }
  return grains;
}

// Eight grains to a cell, so that every cell has the same void fraction.
std::vector<GrainInFlow> even_bed(const CellCounts& cells, double cell, double void_fraction,
                                  double mass) {
  const double radius = cell * std::cbrt(3.0 * (1.0 - void_fraction) / (4.0 * kPi) / 8.0);
  std::vector<GrainInFlow> grains;
  for (std::int64_t z = 0; z < 2 * cells[2]; ++z)
    for (std::int64_t y = 0; y < 2 * cells[1]; ++y)
      for (std::int64_t x = 0; x < 2 * cells[0]; ++x) {
        GrainInFlow g;
        g.id = static_cast<std::int64_t>(grains.size());
        g.position = 0.5 * cell *
                     Vec3{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5,
                          static_cast<double>(z) + 0.5};
        g.radius = radius;
        g.mass = mass;
        grains.push_back(g);
      }
  return grains;
}

// Pressure drop of Ergun's equation over the length [Pa m-1] at the flux U.
double ergun(const Fluid& fluid, double diameter, double void_fraction, double flux) {
  const double solid = 1.0 - void_fraction;
  const double n3 = std::pow(void_fraction, 3);
  return 150.0 * fluid.viscosity * flux * solid * solid / (n3 * diameter * diameter) +
         1.75 * fluid.density * flux * flux * solid / (n3 * diameter);
}

TEST(Kernel, LosesNothingInsideAndAtWalls) {
  UnresolvedSettings s = settings_of(kWater, {7, 6, 5}, 0.01, 1e-3);
  for (Face& face : s.lattice.faces[2]) face.kind = FaceKind::kWall;
  UnresolvedFlow fluid(Communicator::alone(), s);
  const auto grains = random_grains(300, 0.0015, 1e-5, {0.07, 0.06, 0.05}, 0.0);
  fluid.look(grains);
  double solid = 0.0;
  for (std::int64_t z = 0; z < 5; ++z)
    for (std::int64_t y = 0; y < 6; ++y)
      for (std::int64_t x = 0; x < 7; ++x) solid += 1.0 - fluid.void_fraction(x, y, z);
  EXPECT_NEAR(solid * 1e-6, 300.0 * volume_of(grains[0]), 1e-14 * solid);
}

TEST(VolumeAveragedFlow, WithoutGrainsIsThePlainOneBitForBit) {
  FlowSettings settings;
  settings.cells = {11, 7, 6};
  settings.parameters.viscosity_lu = 0.03;
  settings.force_lu = {1e-5, -2e-5, 3e-5};
  for (Face& face : settings.faces[1]) face.kind = FaceKind::kWall;
  const auto plain = make_flow(Communicator::alone(), settings);
  const auto averaged = make_flow(Communicator::alone(), settings);
  averaged->average();
  for (const auto& flow : {plain.get(), averaged.get()})
    flow->set_equilibrium([](const Vec3& p) {
      return FlowNode{1.0 + 0.01 * std::sin(p.x),
                      {0.02 * std::cos(p.y), 0.01 * std::sin(p.z), 0.0}};
    });
  for (int i = 0; i < 31; ++i) {
    plain->step();
    averaged->step();
  }
  for (std::int64_t y = 0; y < 7; ++y)
    for (std::size_t i = 0; i < 19; ++i)
      EXPECT_EQ(averaged->population(i, 5, y, 3), plain->population(i, 5, y, 3));
}

TEST(VolumeAveragedFlow, AtRestStaysAtRestAtAnyVoidFraction) {
  UnresolvedFlow fluid(Communicator::alone(), settings_of(kWater, {6, 6, 6}, 0.01, 1e-3));
  auto grains = random_grains(5000, 0.0018, kFixed, {0.06, 0.06, 0.06}, 0.0);
  auto pores = fluid.look(grains);
  EXPECT_LT(fluid.least_void_fraction(), 0.5);
  for (int i = 0; i < 50; ++i)
    for (const Vec3& force : fluid.step(grains, pores)) EXPECT_EQ(norm(force), 0.0);
}

TEST(MomentumExchange, KeepsTheSumOfFluidAndGrainsToRounding) {
  for (const ExchangeModel model : {ExchangeModel::kA, ExchangeModel::kB})
    for (const char* law : {"stokes", "gidaspow", "koch_hill", "beetstra"}) {
      UnresolvedSettings s = settings_of(kWater, {8, 7, 6}, 0.01, 1e-3);
      s.model = model;
      s.drag = law;
      UnresolvedFlow fluid(Communicator::alone(), s);
      const Vec3 size{0.08, 0.07, 0.06};
      auto grains = random_grains(300, 0.0015, 2500.0 * 1.4e-8, size, 0.2);
      auto pores = fluid.look(grains);
      const auto total = [&] {
        Vec3 sum = fluid.momentum();
        for (const GrainInFlow& g : grains) sum += g.mass * g.velocity;
        return sum;
      };
      const Vec3 before = total();
      double exchanged = 0.0;
      for (int i = 0; i < 200; ++i) {
        const auto forces = fluid.step(grains, pores);
        for (std::size_t g = 0; g < grains.size(); ++g) {
          exchanged += s.time_step * norm(forces[g]);
          grains[g].velocity += (s.time_step / grains[g].mass) * forces[g];
          Vec3& p = grains[g].position;
          p += s.time_step * grains[g].velocity;
          p = {std::fmod(p.x + size.x, size.x), std::fmod(p.y + size.y, size.y),
               std::fmod(p.z + size.z, size.z)};
        }
      }
      // A population of 1e-2 rounds by 2e-18, twenty of them in each of 336 cells and 200 steps.
      EXPECT_GT(exchanged, 1e-5);
      EXPECT_LT(norm(total() - before), 1e-12 * exchanged) << law;
    }
}

// Flux through a periodic even bed under a fall of the pressure. @return over what Ergun asks
double flux_of_bed(ExchangeModel model, const Fluid& fluid, double void_fraction, double fall,
                   double time_step) {
  const CellCounts cells{3, 3, 3};
  UnresolvedSettings s = settings_of(fluid, cells, 0.005, time_step);
  s.model = model;
  s.drag = "gidaspow";
  s.pressure_fall = {fall, 0.0, 0.0};
  UnresolvedFlow flow(Communicator::alone(), s);
  const auto grains = even_bed(cells, s.cell, void_fraction, kFixed);
  auto pores = flow.look(grains);
  for (int i = 0; i < 600; ++i) flow.step(grains, pores);
  const double flux = void_fraction * flow.velocity(2, 1, 1).x;
  return ergun(fluid, 2.0 * grains[0].radius, void_fraction, flux) / (fluid.density * fall);
}

TEST(PorousBed, HasErgunsPressureDropFromDarcysRegimeToInertia) {
  // Uniform: what is left of the start after the steps is below the tolerance.
  for (const ExchangeModel model : {ExchangeModel::kA, ExchangeModel::kB})
    for (const double voids : {0.4, 0.6}) {
      EXPECT_NEAR(flux_of_bed(model, kSyrup, voids, 1.0, 2e-6), 1.0, 1e-3) << voids;
      EXPECT_NEAR(flux_of_bed(model, kWater, voids, 0.01, 1e-3), 1.0, 1e-3) << voids;
      EXPECT_NEAR(flux_of_bed(model, kWater, voids, 10.0, 1e-4), 1.0, 1e-3) << voids;
    }
}

// A bed between an inflow and an outflow: pressure drop within it over Ergun's.
double drop_in_bed(ExchangeModel model, double flux) {
  UnresolvedSettings s = settings_of(kSyrup, {30, 2, 2}, 0.005, 2e-6);
  s.model = model;
  s.drag = "gidaspow";
  s.lattice.faces[0][0].kind = FaceKind::kVelocity;
  s.lattice.faces[0][0].velocity_lu = {flux * s.time_step / s.cell, 0.0, 0.0};
  s.lattice.faces[0][1].kind = FaceKind::kPressure;
  UnresolvedFlow flow(Communicator::alone(), s);
  const double voids = 0.42;
  auto grains = even_bed({16, 2, 2}, s.cell, voids, kFixed);
  for (GrainInFlow& g : grains) g.position.x += 7.0 * s.cell;
  auto pores = flow.look(grains);
  // Sound of the start goes on for long: means over some of its periods.
  double drop = 0.0;
  for (int i = 0; i < 3000; ++i) {
    flow.step(grains, pores);
    if (i >= 2000) drop += 1e-3 * (flow.pressure(10, 1, 1) - flow.pressure(20, 1, 1));
  }
  return drop / (10.0 * s.cell * ergun(kSyrup, 2.0 * grains[0].radius, voids, flux));
}

TEST(PorousBed, HasTheSameDropBetweenOpenFacesInBothModelsAndDarcysSlope) {
  // Away from its ends, which are as wide as the kernel. A viscosity of 7e-5 in lattice units does
  // not damp what changes from cell to cell: 0.3 % of the pressure.
  for (const ExchangeModel model : {ExchangeModel::kA, ExchangeModel::kB}) {
    const double slow = drop_in_bed(model, 1e-3);
    EXPECT_NEAR(slow, 1.0, 0.02);
    EXPECT_NEAR(drop_in_bed(model, 2e-3) / slow, 1.0, 3e-3);
  }
}

TEST(Suspension, SettlesAtTheHinderedSpeedAndIsCarriedByExcessPorePressure) {
  // Closed below and above: grains go down as fluid goes up, n u + (1 - n) v = 0, and drag and
  // pressure carry them. Until grains have moved a cell the suspension is uniform.
  for (const ExchangeModel model : {ExchangeModel::kA, ExchangeModel::kB}) {
    const CellCounts cells{2, 2, 24};
    const double voids = 0.8;
    const double excess = 1300.0;  // of the grains' density
    UnresolvedSettings s = settings_of(kSyrup, cells, 0.005, 2e-6);
    s.model = model;
    s.drag = "wen_yu";
    for (Face& face : s.lattice.faces[2]) face.kind = FaceKind::kWall;
    UnresolvedFlow flow(Communicator::alone(), s);
    auto grains = even_bed(cells, s.cell, voids, 1.0);
    const double volume = volume_of(grains[0]);
    for (GrainInFlow& g : grains) {
      g.mass = (s.fluid.density + excess) * volume;
      g.other_force = {0.0, 0.0, -excess * volume * 9.81};
    }
    auto pores = flow.look(grains);
    double gradient = 0.0;  // mean over some periods of the sound of the start
    for (int i = 0; i < 3000; ++i) {
      const auto forces = flow.step(grains, pores);
      for (std::size_t g = 0; g < grains.size(); ++g) {
        grains[g].velocity += (s.time_step / grains[g].mass) * (forces[g] + grains[g].other_force);
        grains[g].position += s.time_step * grains[g].velocity;
      }
      if (i >= 2000)
        gradient += 1e-3 * (flow.pressure(1, 1, 8) - flow.pressure(1, 1, 16)) / (8.0 * s.cell);
    }
    const double d = 2.0 * grains[0].radius;
    // n x weight = drag of the slip, which is -v/n; creeping.
    const double slip = voids * excess * volume * 9.81 /
                        (3.0 * kPi * s.fluid.viscosity * d * WenYuDrag::factor(0.0, voids));
    const GrainInFlow& middle = grains[grains.size() / 2];
    EXPECT_NEAR(middle.velocity.z / (-voids * slip), 1.0, 0.01);
    EXPECT_NEAR(gradient / ((1.0 - voids) * excess * 9.81), 1.0, 0.01);
  }
}

TEST(VoidFraction, OfZeroIsRefused) {
  UnresolvedFlow fluid(Communicator::alone(), settings_of(kWater, {4, 4, 4}, 0.01, 1e-3));
  auto grains = random_grains(40, 0.004, 1e-4, {0.01, 0.01, 0.01}, 0.0);
  EXPECT_THROW(fluid.look(grains), ConfigError);
}

TEST(Cell, SmallerThanAGrainIsRefused) {
  const UnresolvedSettings s = settings_of(kWater, {4, 4, 4}, 0.01, 1e-3);
  EXPECT_TRUE(UnresolvedFlow::problems_of(s, 0.005).empty());
  EXPECT_EQ(UnresolvedFlow::problems_of(s, 0.011).size(), 1u);
}

}  // namespace
}  // namespace grouser
