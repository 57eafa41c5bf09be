// SPDX-License-Identifier: BSD-3-Clause
#include "engine/app/energy_ledger.hpp"

#include <algorithm>

#include "base/errors.hpp"

namespace grouser {
namespace {

constexpr const char* kTable = "energy";

}  // namespace

void EnergyLedger::add_work(const World& world) {
  double power = 0.0;
  for (std::size_t b = 0; b < world.bodies(); ++b) {
    const BodyLoad& load = world.load(b);
    const BodyMotion& motion = world.body(b).motion;
    power -= load.force_x.value() * motion.velocity.x + load.force_y.value() * motion.velocity.y +
             load.force_z.value() * motion.velocity.z + load.moment_y() * motion.spin;
  }
  work_ += power * world.settings().time_step;
}

bool EnergyLedger::rises(const World::Survey& survey) {
  const double left = survey.total() - work_;
  lowest_ = std::min(lowest_, left);
  rise_ = left - lowest_;
  return rise_ > 0.5 * survey.kinetic && rise_ > kShare * survey.elastic;
}

void EnergyLedger::save_state(State& state, const StatePiece& piece) const {
  StateTable table;
  table.name = kTable;
  table.key_count = table.all_rows = 1;
  table.real_fields = {{"work", "J", 1}, {"lowest", "J", 1}};
  if (ranks_.rank() == 0 && piece.has(0, 1)) {
    table.integers = {0, 0};
    table.reals = {work_, lowest_};
  }
  state.push_back(std::move(table));
}

void EnergyLedger::load_rows(const StateTable& rows) {
  if (rows.name != kTable) return;
  const std::vector<double> row = first_row(ranks_, rows);
  if (row.size() != 2) throw FormatError("the checkpoint has another kind of energy ledger");
  work_ = row[0];
  lowest_ = row[1];
}

}  // namespace grouser
