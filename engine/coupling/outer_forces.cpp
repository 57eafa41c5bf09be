// SPDX-License-Identifier: BSD-3-Clause
#include "engine/coupling/outer_forces.hpp"

#include <algorithm>
#include <numbers>

#include "base/errors.hpp"

namespace grouser {
namespace {

constexpr const char* kTable = "fluid_history";
constexpr std::size_t kMemoryWidth = 3 * HistoryModes::kModes;

std::string three(const std::string& name, const std::string& unit) {
  return "," + name + "_x [" + unit + "]," + name + "_y [" + unit + "]," + name + "_z [" + unit +
         "]";
}

void push(std::vector<double>& to, const Vec3& v) { to.insert(to.end(), {v.x, v.y, v.z}); }

Vec3 along(const std::string& axis, double size) {
  if (axis == "x") return {size, 0.0, 0.0};
  if (axis == "y") return {0.0, size, 0.0};
  return {0.0, 0.0, size};
}

StateTable history_table() {
  StateTable table;
  table.name = kTable;
  table.real_fields = {{"memory", "m s-1", static_cast<int>(kMemoryWidth)}};
  return table;
}

}  // namespace

std::string track_header() {
  std::string text = "step [1],time [s],x [m],y [m],z [m]" + three("velocity", "m s-1") +
                     three("acceleration", "m s-2") + three("spin", "rad s-1") +
                     ",gap [m],reynolds [1],contacts [1]";
  for (const char* part : kPartNames) text += three(part, "N");
  return text;
}

std::vector<double> track_values(const TrackRow& row) {
  std::vector<double> values;
  push(values, row.position);
  push(values, row.velocity);
  push(values, row.acceleration);
  push(values, row.spin);
  values.insert(values.end(), {row.gap, row.reynolds, row.contacts});
  for (const Vec3& force : row.parts.force) push(values, force);
  return values;
}

OuterForces::OuterForces(const Case& input, World& world)
    : world_(world),
      walls_{input.box.length, input.box.width},
      probes_(input.probes),
      input_(input.fluid) {
  if (input.output.has_track) tracked_ = input.output.track.grain;
  const WorldSettings& settings = world.settings();
  if (has_lattice(input))
    lattice_ = std::make_unique<ResolvedFlow>(input, world);
  else if (input.has_fluid)
    fluid_.emplace(input.fluid, walls_, settings.time_step, settings.gravity);
  world.set_grain_forces(this);
}

OuterForces::~OuterForces() { world_.set_grain_forces(nullptr); }

bool OuterForces::are_in(const Case& input) {
  return input.has_fluid || !input.probes.empty() || input.output.has_track;
}

void OuterForces::announce(std::int64_t step, double time, bool with_track) {
  if (lattice_) lattice_->advance(step);
  time_ = time;
  wants_row_ = with_track && tracked_ >= 0;
  row_.reset();
}

void OuterForces::load_bodies() {
  if (lattice_ && lattice_->wheel()) world_.add_load(*lattice_->wheel(), lattice_->wheel_load());
}

std::optional<TrackRow> OuterForces::take_row() {
  if (!wants_row_) return std::nullopt;
  std::vector<Bytes> out(static_cast<std::size_t>(world_.ranks().size()));
  if (row_) append_bytes(out[0], &*row_, 1);
  std::optional<TrackRow> found;
  for (const Bytes& message : world_.ranks().exchange_all(out))
    if (!message.empty()) ByteReader(message).take(&found.emplace(), 1);
  return found;
}

void OuterForces::begin_step(const std::vector<Particle>& particles, std::size_t owned) {
  // Here and not where it is asked for: threads ask.
  if (fluid_ && fluid_->has_history() && memories_.size() < owned)
    for (std::size_t i = 0; i < owned; ++i) memories_.try_emplace(particles[i].id);
  if (!wants_row_) return;
  const auto last = particles.begin() + static_cast<std::ptrdiff_t>(owned);
  const auto tracked =
      std::find_if(particles.begin(), last, [&](const Particle& p) { return p.id == tracked_; });
  if (tracked == last) return;
  const Vec3 at = tracked->position;
  const double r = tracked->radius;
  contacts_ = 0.0;
  for (const Particle& other : particles)
    if (other.id != tracked_ && norm(other.position - at) < r + other.radius) ++contacts_;
  for (const double distance : {at.x, walls_.length - at.x, at.y, walls_.width - at.y, at.z})
    if (distance < r) ++contacts_;
}

Vec3 OuterForces::probe_force(const Particle& p) const {
  Vec3 force;
  for (const ProbeCase& probe : probes_) {
    if (probe.grain != p.id) continue;
    const double value = probe.along == "time"    ? time_
                         : probe.along == "gap"   ? p.position.z - p.radius
                         : probe.along == "speed" ? norm(p.velocity)
                                                  : reynolds(p, p.velocity);
    force += along(probe.axis, probe.at(value));
  }
  return force;
}

// Of the fluid as it is prescribed; on a lattice, of the fluid at rest.
double OuterForces::reynolds(const Particle& p, const Vec3& velocity) const {
  if (fluid_) return fluid_->reynolds(p, velocity);
  if (!lattice_) return 0.0;
  return Fluid{input_.density, input_.viscosity}.reynolds(2.0 * p.radius, norm(velocity));
}

GrainGain OuterForces::lattice_gain(const Particle& p, const GrainLoad& load, const Vec3& probe,
                                    ForceParts& parts) const {
  const WorldSettings& settings = world_.settings();
  const GrainLoad fluid = lattice_->load(p.id);
  const double displaced = input_.density * 4.0 / 3.0 * std::numbers::pi * p.radius * p.radius *
                           p.radius * lattice_->wet_share(p);
  const Vec3 lift{0.0, 0.0, input_.buoyancy.amplitude * displaced * settings.gravity};
  parts.force[ForceParts::kContact] = load.force;
  parts.force[ForceParts::kWeight] = {0.0, 0.0, -p.mass * settings.gravity};
  parts.force[ForceParts::kBuoyancy] = lift;
  parts.force[ForceParts::kDrag] = fluid.force;
  parts.force[ForceParts::kProbe] = probe;
  return plain_gain(p, {load.force + fluid.force + lift + probe, load.moment + fluid.moment},
                    settings.time_step, settings.gravity);
}

GrainGain OuterForces::gain(const Particle& p, const GrainLoad& load) {
  const WorldSettings& settings = world_.settings();
  const Vec3 probe = probes_.empty() ? Vec3{} : probe_force(p);
  ForceParts parts;
  GrainGain gain;
  if (lattice_) {
    gain = lattice_gain(p, load, probe, parts);
  } else if (fluid_) {
    HistoryModes::Memory* memory = fluid_->has_history() ? &memories_.at(p.id) : nullptr;
    gain = fluid_->gain(p, load, probe, memory, parts);
  } else {
    gain = plain_gain(p, {load.force + probe, load.moment}, settings.time_step, settings.gravity);
    parts.force[ForceParts::kContact] = load.force;
    parts.force[ForceParts::kWeight] = {0.0, 0.0, -p.mass * settings.gravity};
    parts.force[ForceParts::kProbe] = probe;
  }
  if (wants_row_ && p.id == tracked_) record(p, gain, parts);
  return gain;
}

void OuterForces::record(const Particle& p, const GrainGain& gain, const ForceParts& parts) {
  TrackRow& row = row_.emplace();
  row.position = p.position;
  row.velocity = p.velocity + 0.5 * gain.velocity;
  row.acceleration = (1.0 / world_.settings().time_step) * gain.velocity;
  row.spin = p.spin + 0.5 * gain.spin;
  row.gap = p.position.z - p.radius;
  row.reynolds = reynolds(p, row.velocity);
  row.contacts = contacts_;
  row.parts = parts;
}

void OuterForces::give(std::int64_t id, Bytes& to) {
  if (lattice_) lattice_->give(id, to);
  const auto found = memories_.find(id);
  if (found == memories_.end()) return;
  append_bytes(to, &found->second, 1);
  memories_.erase(found);
}

void OuterForces::take(std::int64_t id, ByteReader& from) {
  if (lattice_)
    lattice_->take(id, from);
  else
    from.take(&memories_[id], 1);
}

void OuterForces::begin_load() {
  memories_.clear();
  if (lattice_) lattice_->begin_load();
}

void OuterForces::end_load() {
  if (lattice_) lattice_->end_load();
}

void OuterForces::save_state(State& state, const StatePiece& piece) const {
  if (lattice_) lattice_->save_state(state, piece);
  if (!fluid_ || !fluid_->has_history()) return;
  StateTable table = history_table();
  table.key_count = world_.particle_count();
  table.all_rows = world_.ranks().sum(static_cast<std::int64_t>(memories_.size()));
  for (const auto& [id, memory] : memories_) {
    if (!piece.has(id, table.key_count)) continue;
    table.integers.insert(table.integers.end(), {id, 0});
    for (const Vec3& mode : memory) push(table.reals, mode);
  }
  state.push_back(std::move(table));
}

void OuterForces::load_rows(const StateTable& rows) {
  if (lattice_) lattice_->load_rows(rows);
  if (rows.name != kTable || !fluid_ || !fluid_->has_history()) return;
  if (rows.real_width() != kMemoryWidth)
    throw FormatError("the checkpoint's fluid_history has another width");
  // To where the world keeps the grains it loads, until their owners take them.
  StateTable sorted = rows;
  sort_rows(world_.ranks(), sorted);
  const double* from = sorted.reals.data();
  for (std::size_t row = 0; row < sorted.rows(); ++row) {
    HistoryModes::Memory& memory = memories_[sorted.integers[row * sorted.integer_width()]];
    for (Vec3& mode : memory) {
      mode = {from[0], from[1], from[2]};
      from += 3;
    }
  }
}

}  // namespace grouser
