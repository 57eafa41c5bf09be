// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/activity.hpp"

#include "base/errors.hpp"

namespace grouser {
namespace {

constexpr const char* kTable = "activity";

}  // namespace

void Activity::begin_step(const std::vector<Particle>& particles, std::size_t owned, bool are_new) {
  has_changed_ = are_new || may_have_changed_;
  asleep_.resize(particles.size());
  // Owned grains change in rests(), which keeps the flags; ghosts by their owners.
  for (std::size_t i = are_new ? 0 : owned; i < particles.size(); ++i) {
    const std::uint8_t now = grouser::is_asleep(particles[i]) ? 1 : 0;
    has_changed_ |= asleep_[i] != now;
    asleep_[i] = now;
  }
  is_look_ = (steps_ + 1) % rule_.interval == 0;
  may_wake_ = (steps_ + 1) % kWakeInterval == 0;
  marked_.assign(particles.size(), 0);
  if (!is_look_) return;
  slow_.resize(particles.size());
  const double limit2 = rule_.speed * rule_.speed;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Particle& p = particles[i];
    slow_[i] = norm2(p.velocity) < limit2 && p.radius * p.radius * norm2(p.spin) < limit2 ? 1 : 0;
  }
}

// A sleeping grain to be tested when it may wake has velocity.x = -0.0, so that a touch that was
// lost before is not forgotten.
void Activity::light_alone(const std::vector<Particle>& particles) {
  lit_.resize(asleep_.size());
  for (std::size_t i = 0; i < asleep_.size(); ++i)
    lit_[i] = asleep_[i] == 0 || std::signbit(particles[i].velocity.x) ? 1 : 0;
}

bool Activity::is_out_of_balance(const Particle& p, Vec3 force, const Vec3& moment,
                                 double share) const {
  force.z -= p.mass * gravity_;
  const double limit = share * p.mass * gravity_;
  // Written so that what is not a number wakes.
  return !(norm2(force) <= limit * limit && norm2(moment) <= limit * limit * p.radius * p.radius);
}

bool Activity::rests(std::size_t grain, Particle& p, const Vec3& force, const Vec3& moment,
                     Change& change) {
  if (asleep_[grain] != 0) {
    if (marked_[grain] != 0) p.velocity.x = -0.0;
    if (!may_wake_ || !std::signbit(p.velocity.x)) return true;
    p.velocity.x = 0.0;
    if (!is_out_of_balance(p, force, moment, rule_.imbalance)) return true;
    p.velocity = {};
    asleep_[grain] = 0;
    change.is_any = true;
    return false;
  }
  if (!is_look_ || marked_[grain] != 0 || slow_[grain] == 0 ||
      is_out_of_balance(p, force, moment, 0.5 * rule_.imbalance))
    return false;
  change.taken.add(kinetic_energy_of(p));
  p.velocity = {0.0, 0.0, -0.0};
  p.spin = {};
  asleep_[grain] = 1;
  change.is_any = true;
  return true;
}

void Activity::end_step(bool is_any, double taken) {
  ++steps_;
  may_have_changed_ = is_any;
  taken_ += taken;
}

void Activity::save_state(const Communicator& ranks, State& state, const StatePiece& piece) const {
  if (!is_on()) return;
  StateTable table;
  table.name = kTable;
  table.key_count = table.all_rows = 1;
  table.real_fields = {{"steps", "1", 1}, {"taken", "J", 1}};
  if (ranks.rank() == 0 && piece.has(0, 1)) {
    table.integers = {0, 0};
    table.reals = {static_cast<double>(steps_), taken_};
  }
  state.push_back(std::move(table));
}

void Activity::load_rows(const Communicator& ranks, const StateTable& rows) {
  if (rows.name != kTable) return;
  const std::vector<double> row = first_row(ranks, rows);
  if (row.size() != 2) throw FormatError("the checkpoint has another kind of activity");
  steps_ = static_cast<std::int64_t>(row[0]);
  taken_ = row[1];
}

}  // namespace grouser
