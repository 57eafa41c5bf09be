// SPDX-License-Identifier: BSD-3-Clause
#include "engine/terrain/wheel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/errors.hpp"

namespace grouser {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double WheelSample::slip(double radius) const {
  return spin * radius > 0.0 ? 1.0 - forward_speed / (spin * radius) : kNan;
}

double WheelSample::skid(double radius) const {
  return forward_speed > 0.0 ? 1.0 - spin * radius / forward_speed : kNan;
}

Wheel::Wheel(const Case& input, World& world, std::size_t body)
    : input_(input.wheel), world_(world), body_(body), gravity_(input.gravity) {
  const double mass = input_.load / gravity_;
  inertia_ = input_.inertia > 0.0 ? input_.inertia : 0.5 * mass * radius() * radius();
}

void Wheel::place() {
  const Vec3 low = world_.settings().low;
  const Vec3 high = world_.settings().high;
  BodyMotion& motion = world_.body(body_).motion;
  start_x_ = low.x + input_.start * (high.x - low.x);
  motion = BodyMotion{};
  motion.position = {start_x_, 0.5 * (low.y + high.y), 0.0};
  const double half = 0.5 * input_.width;
  double height = low.z + radius();  // on the bare floor where there is no grain
  for (std::size_t i = 0; i < world_.owned(); ++i) {
    const Particle& p = world_.particles()[i];
    const double dx = p.position.x - start_x_;
    const double reach = radius() + p.radius;
    if (std::abs(dx) >= reach || std::abs(p.position.y - motion.position.y) >= half + p.radius)
      continue;
    height = std::max(height, p.position.z + std::sqrt(reach * reach - dx * dx));
  }
  motion.position.z = world_.ranks().max(height);
  surface_ = surface_level(world_, std::max(low.x, start_x_ - 0.25 * input_.diameter),
                           std::min(high.x, start_x_ + input_.travel + 0.25 * input_.diameter),
                           motion.position.y - half, motion.position.y + half);
}

double Wheel::speed_factor(double time) const {
  const double since = time - input_.settle_time;
  if (since <= 0.0) return 0.0;
  return since >= input_.ramp_time ? 1.0 : since / input_.ramp_time;
}

double Wheel::drive(BodyMotion& motion, double time, double moment) const {
  const double factor = speed_factor(time);
  const double speed = factor * input_.forward_speed;
  const double dt = world_.settings().time_step;
  if (input_.drive == "torque") {
    if (!is_driving(time)) return -moment;  // held at rest
    const double pull = world_.load(body_).force_x.value();
    motion.velocity.x += dt * pull * gravity_ / input_.load;
    motion.spin += dt * (moment + factor * input_.torque) / inertia_;
    return factor * input_.torque;
  }
  motion.velocity.x = speed;
  // Released once it rolls; without a ramp that is the step after the first.
  if (input_.drive == "towed" && factor >= 1.0 && motion.spin != 0.0) {
    motion.spin += dt * moment / inertia_;
    return 0.0;
  }
  const double before = motion.spin;
  if (input_.drive == "slip") {
    motion.spin = speed / (radius() * (1.0 - input_.slip));
  } else if (input_.drive == "rim_speed") {
    motion.spin = factor * input_.rim_speed / radius();
  } else {
    motion.spin = speed / radius();  // a towed wheel starts rolling without slip
  }
  return -moment + inertia_ * (motion.spin - before) / dt;
}

void Wheel::advance(double time, double max_overlap) {
  BodyMotion& motion = world_.body(body_).motion;
  const BodyLoad& load = world_.load(body_);
  const double dt = world_.settings().time_step;
  const double moment = load.moment_y();
  motion.velocity.z += dt * (load.force_z.value() - input_.load) * gravity_ / input_.load;
  // Implicit, so that a stiff damper cannot overshoot: dv = -(g/v_s) v dt.
  if (!is_driving(time) && input_.settle_speed > 0.0)
    motion.velocity.z /= 1.0 + dt * gravity_ / input_.settle_speed;
  torque_ += drive(motion, time, moment);
  motion.position += dt * motion.velocity;
  motion.angle += dt * motion.spin;

  steps_ += 1.0;
  pull_ += load.force_x.value();
  side_ += load.force_y.value();
  vertical_ += load.force_z.value();
  gross_ -= load.force_moment_y.value() / radius();
  forward_ += motion.velocity.x;
  spin_ += motion.spin;
  overlap_ = std::max(overlap_, max_overlap);
}

std::string Wheel::fault() const {
  const Vec3& axle = world_.body(body_).motion.position;
  const Vec3& low = world_.settings().low;
  const Vec3& high = world_.settings().high;
  if (axle.z - radius() < low.z)
    return "the wheel has sunk to the floor of the box; use a deeper bed";
  // In front of and behind its contact with the soil a wheel may reach over the wall's foot.
  if (axle.x - low.x < 0.25 * radius() || high.x - axle.x < 0.25 * radius())
    return "the wheel has reached an end wall; use a longer box or less travel";
  return "";
}

WheelSample Wheel::take_sample() {
  const BodyMotion& motion = world_.body(body_).motion;
  WheelSample sample;
  const double share = steps_ > 0.0 ? 1.0 / steps_ : 0.0;
  sample.travel = motion.position.x - start_x_;
  sample.sinkage = surface_ - (motion.position.z - radius());
  sample.forward_speed = share * forward_;
  sample.vertical_speed = motion.velocity.z;
  sample.spin = share * spin_;
  sample.pull = share * pull_;
  sample.vertical_force = share * vertical_;
  sample.side_force = share * side_;
  sample.gross_tractive_effort = share * gross_;
  sample.axle_torque = share * torque_;
  sample.max_overlap = overlap_;
  steps_ = pull_ = vertical_ = side_ = gross_ = torque_ = forward_ = spin_ = overlap_ = 0.0;
  return sample;
}

void Wheel::save_state(State& state, const StatePiece& piece) const {
  StateTable table;
  table.name = "wheel";
  table.key_count = table.all_rows = 1;
  table.real_fields = {
      {"start_x", "m", 1},           {"surface", "m", 1},         {"sample_steps", "1", 1},
      {"sample_pull", "N", 1},       {"sample_vertical", "N", 1}, {"sample_side", "N", 1},
      {"sample_gross", "N", 1},      {"sample_torque", "N m", 1}, {"sample_speed", "m s-1", 1},
      {"sample_spin", "rad s-1", 1}, {"sample_overlap", "1", 1}};
  if (world_.ranks().rank() == 0 && piece.has(0, 1)) {
    table.integers = {0, 0};
    table.reals = {start_x_, surface_, steps_,   pull_, vertical_, side_,
                   gross_,   torque_,  forward_, spin_, overlap_};
  }
  state.push_back(std::move(table));
}

void Wheel::load_rows(const StateTable& rows) {
  if (rows.name != "wheel") return;
  const std::vector<double> row = first_row(world_.ranks(), rows);
  const std::array<double*, 11> targets{&start_x_, &surface_, &steps_,   &pull_, &vertical_, &side_,
                                        &gross_,   &torque_,  &forward_, &spin_, &overlap_};
  if (row.size() != targets.size()) throw FormatError("the checkpoint has another kind of wheel");
  for (std::size_t i = 0; i < targets.size(); ++i) *targets[i] = row[i];
  is_loaded_ = true;
}

void Wheel::end_load() {
  if (!is_loaded_) throw FormatError("the checkpoint has no wheel");
}

}  // namespace grouser
