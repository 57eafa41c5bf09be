// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/time_step.hpp"
#include "engine/terrain/bed.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {
namespace {

constexpr int kGrains = 1134;

// A column settled for 0.8 s; made once for all tests that look at it.
World& settled(double friction) {
  static std::map<double, World> beds;
  const auto found = beds.find(friction);
  if (found != beds.end()) return found->second;
  WorldSettings settings = small_settings();
  settings.grain_grain = {0.3, friction, 0.0};
  settings.time_step = 2e-5;  // 0.17 of the Rayleigh time
  World world(Communicator::alone(), settings);
  add_box(world, {0.3, friction, 0.0});
  for (const Particle& p : loose_column(kGrains, 17)) world.add_particle(p);
  for (int i = 0; i < 40000; ++i) world.step();
  return beds.emplace(friction, std::move(world)).first->second;
}

// Solid fraction between heights that keep clear of floor and surface by a diameter.
double solid_fraction(const World& world) {
  const double low = 0.015;
  const double high = 0.035;
  double volume = 0.0;
  for (const Particle& p : world.particles()) {
    // Part of a sphere between two planes, by the cap formula.
    const auto below = [&](double plane) {
      const double h = std::clamp(plane - (p.position.z - p.radius), 0.0, 2.0 * p.radius);
      return std::numbers::pi * h * h * (3.0 * p.radius - h) / 3.0;
    };
    volume += below(high) - below(low);
  }
  return volume / (0.1 * 0.1 * (high - low));
}

TEST(Bed, WallAndFloorForcesCarryTheWeight) {
  World& world = settled(0.5);
  double weight = 0.0;
  for (const Particle& p : world.particles()) weight += p.mass * 9.81;
  // Mean over a while: what little still rattles averages out.
  double carried = 0.0;
  for (int i = 0; i < 2000; ++i) {
    world.step();
    carried -= world.load(0).force_z.value() / 2000.0;
  }
  EXPECT_NEAR(carried / weight, 1.0, 1e-3);
}

// The facets of a box from `first` up to, but without, `last`.
Mesh part_of_box(std::size_t first, std::size_t last) {
  Mesh mesh = box_mesh(0.1, 0.1, 0.4);
  mesh.facets = {mesh.facets.begin() + static_cast<std::ptrdiff_t>(first),
                 mesh.facets.begin() + static_cast<std::ptrdiff_t>(last)};
  return mesh;
}

TEST(Bed, WallsDrawnUpwardCarryTheirFrictionTimesTheirPressure) {
  constexpr double kFriction = 0.5;
  WorldSettings settings = small_settings();
  // Free to roll, grains at a wall turn instead of sliding and hold less.
  settings.rolling = "elastic_plastic";
  settings.grain_grain = {0.3, kFriction, 1.0};
  settings.time_step = 2e-5;
  World world(Communicator::alone(), settings);
  const Surface surface{0.3, kFriction, 1.0};
  const std::size_t floor = world.add_body("floor", part_of_box(0, 2), kTestSolid, surface, false);
  const std::size_t walls = world.add_body("walls", part_of_box(2, 10), kTestSolid, surface, false);
  for (const Particle& p : loose_column(kGrains, 17)) world.add_particle(p);
  for (int i = 0; i < 20000; ++i) world.step();
  // A millimetre of travel slides every wall contact (elastic slip is some micrometres).
  BodyMotion& motion = world.body(walls).motion;
  motion.velocity.z = 5e-3;
  double on_floor = 0.0;
  double on_walls = 0.0;
  double pressure = 0.0;
  const double young = kTestSolid.young_modulus / (2.0 * (1.0 - 0.0625));
  constexpr int kSamples = 2000;
  for (int i = 0; i < 10000; ++i) {
    world.step();
    motion.position += settings.time_step * motion.velocity;
    if (i < 10000 - kSamples) continue;
    on_floor -= world.load(floor).force_z.value() / kSamples;
    on_walls -= world.load(walls).force_z.value() / kSamples;
    for (const Particle& p : world.particles())
      for (const double gap : {p.position.x, p.position.y, 0.1 - p.position.x, 0.1 - p.position.y})
        pressure += 4.0 / 3.0 * young * std::sqrt(p.radius) *
                    std::pow(std::max(0.0, p.radius - gap), 1.5) / kSamples;
  }
  double weight = 0.0;
  for (const Particle& p : world.particles()) weight += p.mass * 9.81;
  // Janssen's state: where every wall contact slides, the walls hold mu times their normal force,
  // and never more. Some grains at the wall still roll or rattle: a fifth.
  EXPECT_LE(on_walls, 1.001 * kFriction * pressure);
  EXPECT_GE(on_walls, 0.8 * kFriction * pressure);
  EXPECT_GT(on_walls, 0.15 * weight);
  EXPECT_NEAR((on_floor + on_walls) / weight, 1.0, 0.01);
}

TEST(Bed, PacksAsDenselyAsSpheresDo) {
  // Random packings of spheres lie between about 0.55 (loose, with friction) and 0.64 (close,
  // without; Scott and Kilgour 1969). Walls twelve grains apart take a few per cent off.
  const double with_friction = solid_fraction(settled(0.5));
  const double without = solid_fraction(settled(0.0));
  EXPECT_GT(with_friction, 0.52);
  EXPECT_LT(with_friction, 0.62);
  EXPECT_GT(without, with_friction + 0.01);
  EXPECT_LT(without, 0.66);
}

Case coarse_case() {
  Case input;
  input.box.length = 0.4;
  input.box.width = 0.3;
  input.box.depth = 0.2;
  input.grains.size_curve = {{1e-3, 0.0}, {1.5e-3, 0.5}, {2e-3, 1.0}};
  input.grains.coarse_graining = 10.0;
  input.bed.depth = 0.1;
  return input;
}

TEST(Filling, KeepsGrainsApartInsideTheBox) {
  const Case input = coarse_case();
  const Filling filling(input);
  std::vector<Particle> grains;
  double volume = 0.0;
  for (std::int64_t id = 0; id < filling.count(); ++id) {
    grains.push_back(filling.particle(id));
    volume += grains.back().mass / input.grains.density;
  }
  EXPECT_NEAR(volume / (0.4 * 0.3 * 0.1 * 0.6), 1.0, 0.01);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const Particle& a = grains[i];
    EXPECT_GE(a.position.x, a.radius);
    EXPECT_LE(a.position.y, 0.3 - a.radius);
    EXPECT_GE(a.position.z, a.radius);
    EXPECT_LE(a.position.z, filling.height() - a.radius + 1e-12);
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE(norm(a.position - grains[j].position), a.radius + grains[j].radius - 1e-12);
  }
}

TEST(SizeCurve, DrawsTheCurveItWasGiven) {
  const SizeCurve curve(coarse_case().grains);
  EXPECT_DOUBLE_EQ(curve.diameter_at(0.0), 1e-2);
  EXPECT_DOUBLE_EQ(curve.diameter_at(0.25), 1.25e-2);
  EXPECT_DOUBLE_EQ(curve.mean(), 1.5e-2);
  // <d^3> of a uniform distribution on [1, 2] cm is (2^4 - 1)/4 cm3.
  EXPECT_NEAR(curve.mean_volume(), std::numbers::pi / 6.0 * 3.75e-6, 1e-12);
}

TEST(SizeCurve, ByMassHoldsMoreFineGrainsByNumber) {
  GrainsCase grains = coarse_case().grains;
  const double by_number = SizeCurve(grains).mean();
  grains.size_basis = "mass";
  const SizeCurve by_mass(grains);
  EXPECT_LT(by_mass.mean(), by_number);
  // Half of the mass must still be finer than the curve's middle: sum over even number steps.
  double fine = 0.0;
  double all = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double d = by_mass.diameter_at((i + 0.5) / 20000.0);
    all += d * d * d;
    if (d < 1.5e-2) fine += d * d * d;
  }
  EXPECT_NEAR(fine / all, 0.5, 1e-3);  // 1/20000 is the step of the sum
}

TEST(TimeStep, IsTheAskedShareOfTheRayleighTime) {
  Case input = coarse_case();
  // pi r sqrt(rho/G)/(0.1631 nu + 0.8766) with r = 5 mm, rho = 2650, G = 20 MPa, nu = 0.25.
  const double expected = std::numbers::pi * 5e-3 * std::sqrt(2650.0 / 2e7) / 0.917375;
  EXPECT_NEAR(rayleigh_time(input), expected, 1e-9);
  EXPECT_NEAR(time_step_of(input), 0.2 * expected, 1e-9);
  input.numerics.time_step = 1e-6;
  EXPECT_EQ(time_step_of(input), 1e-6);
}

}  // namespace
}  // namespace grouser
