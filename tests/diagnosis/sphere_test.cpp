// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/models/sphere.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace grouser::diagnosis {
namespace {

Settings nylon_in_oil() {
  Settings s;
  s[Setting::kDiameter] = 0.015;
  s[Setting::kParticleDensity] = 1120.0;
  s[Setting::kFluidDensity] = 960.0;
  s[Setting::kViscosity] = 0.373;
  s[Setting::kReleaseGap] = 0.12;
  return s;
}

ModelPlan plan(double duration, std::vector<Signal> channels) {
  ModelPlan plan;
  for (int i = 0; i <= 200; ++i) plan.times.push_back(duration * i / 200.0);
  plan.channels = std::move(channels);
  return plan;
}

TEST(SphereModel, StokesFallIsTheClosedForm) {
  const Settings s = nylon_in_oil();
  const ModelPlan p = plan(1.0, {Signal::kGap, Signal::kSettlingSpeed});
  const std::vector<double> out = make_sphere_model(p)->run(s, {});
  const double relaxation = 1120.0 * 0.015 * 0.015 / (18.0 * 0.373);
  const double terminal = (1.0 - 960.0 / 1120.0) * 9.81 * relaxation;
  for (std::size_t i = 0; i < p.times.size(); ++i) {
    const double t = p.times[i];
    const double speed = terminal * (1.0 - std::exp(-t / relaxation));
    // The curve is straight between steps of 8 % of the relaxation: (0.08)^2/8 at most.
    EXPECT_NEAR(out[201 + i], speed, 1e-3 * terminal) << t;
    EXPECT_NEAR(out[i], 0.12 - terminal * t + relaxation * speed, 1e-4 * terminal) << t;
  }
}

TEST(SphereModel, AddedMassSlowsTheStartByItsShareOfTheInertia) {
  Settings s = nylon_in_oil();
  s[Setting::kAddedMass] = 1.0;
  const ModelPlan p = plan(0.01, {Signal::kSettlingSpeed});
  const std::vector<double> out = make_sphere_model(p)->run(s, {});
  const double start = (1120.0 - 960.0) * 9.81 / (1120.0 + 480.0);
  // Drag takes off t/(2 relaxation) of the speed, 1 % after 1 ms.
  EXPECT_NEAR(out[20] / p.times[20], start, 0.02 * start);
}

TEST(SphereModel, HistoryForceOfAConstantAccelerationIsTwiceTheRootOfTime) {
  // In a fluid of next to no density beside a heavy sphere the motion is a free fall, on which the
  // history force can be evaluated: 3/2 d^2 sqrt(pi rho mu) * 2 g sqrt(t).
  Settings s = nylon_in_oil();
  s[Setting::kParticleDensity] = 1e7;
  s[Setting::kReleaseGap] = 10.0;
  s[Setting::kBasset] = 1.0;
  const ModelPlan p = plan(1.0, {Signal::kGap});
  const std::vector<double> force = make_sphere_model(p)->force_of(Setting::kBasset, s);
  const double volume = M_PI * 0.015 * 0.015 * 0.015 / 6.0;
  const double weight = volume * (1e7 - 960.0) * 9.81;
  for (const std::size_t i : {10U, 50U, 200U}) {
    const double expected = 1.5 * 0.015 * 0.015 * std::sqrt(M_PI * 960.0 * 0.373) * 2.0 * 9.81 *
                            std::sqrt(p.times[i]) / weight;
    // Drag takes 0.3 % off the acceleration; the sum of exponentials is good to 1 %.
    EXPECT_NEAR(force[i], expected, 0.015 * expected) << p.times[i];
  }
}

TEST(SphereModel, ABounceInVacuumReturnsToTheSquareOfItsRestitution) {
  Settings s = nylon_in_oil();
  s[Setting::kFluidDensity] = 1e-6;
  s[Setting::kViscosity] = 1e-9;
  s[Setting::kRestitution] = 0.8;
  const double fall = std::sqrt(2.0 * 0.12 / 9.81);
  ModelPlan p = plan(fall * (1.0 + 0.8), {Signal::kGap});
  const std::vector<double> out = make_sphere_model(p)->run(s, {});
  // The top of the bounce is the last sample; steps are an 1/300 of the flight.
  EXPECT_NEAR(out.back(), 0.64 * 0.12, 1e-3 * 0.12);
}

TEST(SphereModel, HalvingTheStepChangesLittleWithEveryTermOn) {
  Settings s = nylon_in_oil();
  s[Setting::kViscosity] = 0.058;
  s[Setting::kContainerWidth] = 0.1;
  s[Setting::kRestitution] = 0.7;
  for (const Setting term : {Setting::kDragInertia, Setting::kAddedMass, Setting::kBasset,
                             Setting::kLubrication, Setting::kSideWall})
    s[term] = 1.0;
  const auto model = make_sphere_model(plan(1.5, {Signal::kGap}));
  const std::vector<double> coarse = model->run(s, {});
  s[Setting::kStepFactor] = 0.25;
  const std::vector<double> fine = model->run(s, {});
  for (std::size_t i = 0; i < fine.size(); ++i) EXPECT_NEAR(coarse[i], fine[i], 5e-4 * 0.12) << i;
}

TEST(SphereModel, OneRunTakesLessThanAMillisecond) {
  Settings s = nylon_in_oil();
  s[Setting::kBasset] = 1.0;
  s[Setting::kDragInertia] = 1.0;
  s[Setting::kLubrication] = 1.0;
  const auto model = make_sphere_model(plan(3.0, {Signal::kGap}));
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 50; ++i) model->run(s, {});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  RecordProperty("microseconds", static_cast<int>(taken.count() / 50.0 * 1e6));
  // Ten times the time measured, for a busy machine.
  EXPECT_LT(taken.count() / 50.0, 3e-3);
}

}  // namespace
}  // namespace grouser::diagnosis
