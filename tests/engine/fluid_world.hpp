// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "engine/coupling/outer_forces.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {

/// A case with a fluid in which only drag and buoyancy act, in a box of `size` [m].
inline Case fluid_case(double density, double viscosity, double size) {
  Case input;
  input.box.length = input.box.width = size;
  input.has_fluid = true;
  input.fluid.density = density;
  input.fluid.viscosity = viscosity;
  return input;
}

/// One grain in a fluid, without a box's body around it.
class OneGrain {
 public:
  OneGrain(Case input, const Particle& grain, double time_step, double gravity)
      : world_(Communicator::alone(), settings(input, grain.radius, time_step, gravity)) {
    input.output.has_track = true;
    input.output.track.grain = 0;
    outer_ = std::make_unique<OuterForces>(input, world_);
    world_.add_particle(grain);
  }

  World& world() { return world_; }
  double time() const { return static_cast<double>(steps_) * world_.settings().time_step; }
  const Particle& grain() const { return world_.particles()[0]; }

  /// A step. @return how the grain moved in its middle, which is at time() before the call
  TrackRow step() {
    outer_->announce(steps_, time(), true);
    world_.step();
    ++steps_;
    return *outer_->take_row();
  }

 private:
  static WorldSettings settings(const Case& input, double radius, double time_step,
                                double gravity) {
    WorldSettings s;
    s.low = {-input.box.length, -input.box.width, -100.0};
    s.high = {2.0 * input.box.length, 2.0 * input.box.width, 100.0};
    s.gravity = gravity;
    s.time_step = time_step;
    s.largest_radius = radius;
    s.skin = 0.5 * radius;
    s.grain = kTestSolid;
    return s;
  }

  World world_;
  std::unique_ptr<OuterForces> outer_;
  std::int64_t steps_ = 0;
};

/// y at time `end` of y' = f(t, y), y(0) = start, by the classical Runge-Kutta method.
inline double runge_kutta(const std::function<double(double, double)>& f, double start, double end,
                          int steps) {
  const double h = end / steps;
  double y = start;
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const double k1 = f(t, y);
    const double k2 = f(t + 0.5 * h, y + 0.5 * h * k1);
    const double k3 = f(t + 0.5 * h, y + 0.5 * h * k2);
    const double k4 = f(t + h, y + h * k3);
    y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return y;
}

}  // namespace grouser
