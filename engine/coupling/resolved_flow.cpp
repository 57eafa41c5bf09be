// SPDX-License-Identifier: BSD-3-Clause
#include "engine/coupling/resolved_flow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "base/time_step.hpp"

namespace grouser {
namespace {

constexpr const char* kTable = "fluid_loads";
constexpr const char* kWheelTable = "fluid_wheel_load";
constexpr int kHeldWidth = 12;

void push(std::vector<double>& to, const Vec3& v) { to.insert(to.end(), {v.x, v.y, v.z}); }

FaceKind kind_of(const std::string& word) {
  if (word == "periodic") return FaceKind::kPeriodic;
  if (word == "slip") return FaceKind::kSlip;
  if (word == "velocity") return FaceKind::kVelocity;
  if (word == "pressure") return FaceKind::kPressure;
  if (word == "outflow") return FaceKind::kOutflow;
  return FaceKind::kWall;
}

StateTable held_table(const char* name) {
  StateTable table;
  table.name = name;
  table.real_fields = {
      {"force", "N", 3}, {"moment", "N m", 3}, {"velocity", "m s-1", 3}, {"spin", "rad s-1", 3}};
  return table;
}

double ball_volume(double radius) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

}  // namespace

FlowSettings flow_settings(const Case& input) {
  const LatticeCase& lattice = input.fluid.lattice;
  const LatticeScale scale = lattice_scale(input, time_step_of(input));
  const LatticeUnits& units = scale.units;
  FlowSettings settings;
  settings.lattice = lattice.velocities;
  settings.collision = lattice.collision;
  settings.precision = lattice.precision == "single" ? Precision::kSingle : Precision::kDouble;
  settings.parameters.viscosity_lu = scale.viscosity_lu;
  settings.parameters.smagorinsky = lattice.smagorinsky;
  settings.cells = scale.cells;
  settings.force_lu = {units.acceleration_lu(lattice.acceleration_x),
                       units.acceleration_lu(lattice.acceleration_y),
                       units.acceleration_lu(lattice.acceleration_z)};
  for (std::size_t side = 0; side < lattice.faces.size(); ++side) {
    const LatticeFaceCase& from = lattice.faces[side];
    Face& face = settings.faces[side / 2][side % 2];
    face.kind = kind_of(from.kind);
    face.velocity_lu = {units.velocity_lu(from.velocity_x), units.velocity_lu(from.velocity_y),
                        units.velocity_lu(from.velocity_z)};
    face.density_lu = units.density_lu(from.pressure);
  }
  return settings;
}

ResolvedFlow::ResolvedFlow(const Case& input, const World& world)
    : world_(world),
      scale_(lattice_scale(input, time_step_of(input))),
      magic_(input.fluid.lattice.collision == "bgk"
                 ? 9.0 * scale_.viscosity_lu * scale_.viscosity_lu
                 : CollisionParameters{}.magic),
      density_(input.fluid.density),
      height_(static_cast<double>(scale_.cells[2]) * scale_.units.cell),
      lift_(input.fluid.buoyancy.amplitude * input.fluid.density * input.gravity),
      flow_(make_flow(world.ranks(), flow_settings(input))) {
  for (std::size_t b = 0; b < world.bodies() && !wheel_; ++b)
    if (world.body(b).turns) wheel_ = b;
  const FluidCase& fluid = input.fluid;
  const LatticeUnits& units = scale_.units;
  flow_->set_equilibrium([&](const Vec3& cell) {
    const double z = (cell.z + 0.5) * units.cell;
    return FlowNode{1.0,
                    {units.velocity_lu(fluid.velocity_x + fluid.shear_rate * z),
                     units.velocity_lu(fluid.velocity_y), units.velocity_lu(fluid.velocity_z)}};
  });
}

void ResolvedFlow::advance(std::int64_t step) {
  if (step % scale_.substeps != 0) return;
  const Communicator& ranks = world_.ranks();
  const std::vector<Bytes> arrived = ranks.exchange_all(send_grains());
  std::vector<Sent> grains;
  std::vector<std::size_t> from;
  for (std::size_t rank = 0; rank < arrived.size(); ++rank)
    for (ByteReader reader(arrived[rank]); !reader.empty();) {
      reader.take(&grains.emplace_back(), 1);
      from.push_back(rank);
    }
  // Where several cover a cell they are added up in this order on any number of ranks.
  std::vector<std::size_t> order(grains.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return grains[a].id < grains[b].id; });
  std::vector<ImmersedBall> balls;
  for (const std::size_t i : order) balls.push_back(grains[i].ball);
  std::vector<ImmersedBody> bodies;
  if (wheel_) bodies.push_back(wheel_body());
  flow_->immerse(balls, bodies);
  flow_->step();
  std::vector<Bytes> answers(arrived.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    Bytes& to = answers[from[order[k]]];
    append_bytes(to, &grains[order[k]].place, 1);
    append_bytes(to, &flow_->immersed_loads()[k], 1);
  }
  receive_loads(ranks.exchange_all(answers));
  if (wheel_) hold_wheel(flow_->immersed_loads().back());
}

ImmersedBody ResolvedFlow::wheel_body() const {
  const LatticeUnits& units = scale_.units;
  const Body& wheel = world_.body(*wheel_);
  const BodyFrame frame(wheel.motion);
  const auto cells = [&](const Vec3& at) { return (1.0 / units.cell) * at - Vec3{0.5, 0.5, 0.5}; };
  ImmersedBody body;
  for (const Vec3& vertex : wheel.search->mesh().vertices)
    body.corners.push_back(cells(frame.to_world(vertex)));
  body.facets = wheel.search->mesh().facets;
  body.centre = cells(wheel.motion.position);
  body.velocity = (units.step / units.cell) * wheel.motion.velocity;
  body.spin = {0.0, units.step * wheel.motion.spin, 0.0};
  return body;
}

void ResolvedFlow::hold_wheel(const ImmersedLoad& local) {
  Communicator::StepTotals totals;
  totals.sums.insert(totals.sums.end(), local.force.begin(), local.force.end());
  totals.sums.insert(totals.sums.end(), local.moment.begin(), local.moment.end());
  totals.sums.push_back(local.volume);
  world_.ranks().combine(totals);
  ImmersedLoad load;
  std::copy_n(totals.sums.begin(), 3, load.force.begin());
  std::copy_n(totals.sums.begin() + 3, 3, load.moment.begin());
  const Body& wheel = world_.body(*wheel_);
  const BodyMotion& motion = wheel.motion;
  Held& held = wheel_held_;
  if (!wheel_moved_) {
    held.velocity = motion.velocity;
    held.spin = {0.0, motion.spin, 0.0};
  }
  wheel_moved_ = true;
  const LatticeUnits& units = scale_.units;
  const double volume = totals.sums.back().value() * std::pow(units.cell, 3);
  const double inside = density_ * volume;
  // As of a cylinder; a rim with grousers has somewhat more.
  const double turning = 0.5 * inside * wheel.search->rim() * wheel.search->rim();
  held.force = units.force(1.0) * load.force_lu() +
               (inside / units.step) * (motion.velocity - held.velocity) +
               Vec3{0.0, 0.0, lift_ * volume};
  held.moment = units.moment(1.0) * load.moment_lu() +
                Vec3{0.0, turning / units.step * (motion.spin - held.spin.y), 0.0};
  held.velocity = motion.velocity;
  held.spin = {0.0, motion.spin, 0.0};
}

BodyLoad ResolvedFlow::wheel_load() const {
  BodyLoad load;
  load.force_x.add(wheel_held_.force.x);
  load.force_y.add(wheel_held_.force.y);
  load.force_z.add(wheel_held_.force.z);
  load.force_moment_y.add(wheel_held_.moment.y);
  return load;
}

ImmersedBall ResolvedFlow::ball_of(const Particle& p) const {
  const LatticeUnits& units = scale_.units;
  const double radius = p.radius / units.cell;
  ImmersedBall ball;
  // Centres of cells are at whole numbers, the box begins half a cell before the first.
  ball.centre = (1.0 / units.cell) * p.position - Vec3{0.5, 0.5, 0.5};
  ball.radius = radius + immersed_excess(radius, scale_.viscosity_lu, magic_);
  ball.velocity = (units.step / units.cell) * p.velocity;
  ball.spin = units.step * p.spin;
  return ball;
}

std::vector<Bytes> ResolvedFlow::send_grains() const {
  std::vector<Bytes> out(static_cast<std::size_t>(world_.ranks().size()));
  for (std::size_t i = 0; i < world_.owned(); ++i) {
    const Particle& p = world_.particles()[i];
    const Sent sent{p.id, static_cast<std::int64_t>(i), ball_of(p)};
    for (const int rank : flow_->blocks().owners_within(sent.ball.centre, sent.ball.radius + 1.0))
      append_bytes(out[static_cast<std::size_t>(rank)], &sent, 1);
  }
  return out;
}

void ResolvedFlow::receive_loads(const std::vector<Bytes>& answers) {
  std::vector<ImmersedLoad> loads(world_.owned());
  for (const Bytes& answer : answers)
    for (ByteReader reader(answer); !reader.empty();) {
      std::int64_t place = 0;
      ImmersedLoad part;
      reader.take(&place, 1);
      reader.take(&part, 1);
      loads[static_cast<std::size_t>(place)].add(part);
    }
  for (std::size_t i = 0; i < loads.size(); ++i) hold(world_.particles()[i], loads[i]);
}

void ResolvedFlow::hold(const Particle& p, const ImmersedLoad& load) {
  const auto [at, is_new] = held_.try_emplace(p.id);
  Held& held = at->second;
  if (is_new) {
    held.velocity = p.velocity;
    held.spin = p.spin;
  }
  const LatticeUnits& units = scale_.units;
  const double inside = density_ * ball_volume(p.radius) * wet_share(p);
  const double turning = kSphereInertia * inside * p.radius * p.radius;
  held.force =
      units.force(1.0) * load.force_lu() + (inside / units.step) * (p.velocity - held.velocity);
  held.moment =
      units.moment(1.0) * load.moment_lu() + (turning / units.step) * (p.spin - held.spin);
  held.velocity = p.velocity;
  held.spin = p.spin;
}

GrainLoad ResolvedFlow::load(std::int64_t id) const {
  const Held& held = held_.at(id);
  return {held.force, held.moment};
}

double ResolvedFlow::wet_share(const Particle& p) const {
  // Of the height of the cap below the surface, h: h^2 (3 r - h) / (4 r^3).
  const double h = std::clamp((height_ - p.position.z) / p.radius + 1.0, 0.0, 2.0);
  return 0.25 * h * h * (3.0 - h);
}

void ResolvedFlow::give(std::int64_t id, Bytes& to) {
  const auto found = held_.find(id);
  if (found == held_.end()) return;
  append_bytes(to, &found->second, 1);
  held_.erase(found);
}

void ResolvedFlow::take(std::int64_t id, ByteReader& from) { from.take(&held_[id], 1); }

void ResolvedFlow::save_state(State& state, const StatePiece& piece) const {
  flow_->save_state(state, piece);
  StateTable table = held_table(kTable);
  table.key_count = world_.particle_count();
  table.all_rows = world_.ranks().sum(static_cast<std::int64_t>(held_.size()));
  for (const auto& [id, held] : held_) {
    if (!piece.has(id, table.key_count)) continue;
    table.integers.insert(table.integers.end(), {id, 0});
    for (const Vec3& v : {held.force, held.moment, held.velocity, held.spin}) push(table.reals, v);
  }
  state.push_back(std::move(table));
  if (!wheel_) return;
  StateTable axle = held_table(kWheelTable);
  axle.key_count = 1;
  axle.all_rows = wheel_moved_ ? 1 : 0;
  if (wheel_moved_ && world_.ranks().rank() == 0 && piece.has(0, 1)) {
    axle.integers = {0, 0};
    push(axle.reals, wheel_held_.force);
    push(axle.reals, wheel_held_.moment);
    push(axle.reals, wheel_held_.velocity);
    push(axle.reals, wheel_held_.spin);
  }
  state.push_back(std::move(axle));
}

void ResolvedFlow::begin_load() {
  held_.clear();
  wheel_moved_ = false;
  flow_->begin_load();
}

void ResolvedFlow::load_rows(const StateTable& rows) {
  flow_->load_rows(rows);
  if (rows.name == kWheelTable && wheel_) {
    const std::vector<double> row = first_row(world_.ranks(), rows);
    if (row.size() != kHeldWidth)
      throw FormatError("the checkpoint has another wheel in the fluid");
    if (!std::isfinite(row[0])) return;  // there is none, or not in this piece
    const auto three = [&](std::size_t at) { return Vec3{row[at], row[at + 1], row[at + 2]}; };
    wheel_held_ = {three(0), three(3), three(6), three(9)};
    wheel_moved_ = true;
  }
  if (rows.name != kTable) return;
  if (rows.real_width() != kHeldWidth)
    throw FormatError("the checkpoint's fluid_loads have another width");
  // To where the world keeps the grains it loads, until their owners take them.
  StateTable sorted = rows;
  sort_rows(world_.ranks(), sorted);
  const double* from = sorted.reals.data();
  for (std::size_t row = 0; row < sorted.rows(); ++row) {
    Held& held = held_[sorted.integers[row * sorted.integer_width()]];
    for (Vec3* v : {&held.force, &held.moment, &held.velocity, &held.spin}) {
      *v = {from[0], from[1], from[2]};
      from += 3;
    }
  }
}

}  // namespace grouser
