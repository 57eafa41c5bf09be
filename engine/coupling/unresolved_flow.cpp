// SPDX-License-Identifier: BSD-3-Clause
#include "engine/coupling/unresolved_flow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grouser {
namespace {

using Fields = AveragedFields;
constexpr const char* kTable = "void_fractions";

FlowSettings lattice_of(const UnresolvedSettings& s) {
  FlowSettings lattice = s.lattice;
  lattice.parameters.viscosity_lu =
      s.fluid.viscosity / s.fluid.density * s.time_step / (s.cell * s.cell);
  lattice.force_lu = (s.time_step * s.time_step / s.cell) * s.pressure_fall;
  return lattice;
}

Problem problem(const std::string& key, const std::string& what, const std::string& hint) {
  return Problem{"", 0, 0, key, what, hint};
}

}  // namespace

std::vector<Problem> UnresolvedFlow::problems_of(const UnresolvedSettings& s, double largest) {
  std::vector<Problem> problems = grouser::problems_of(lattice_of(s));
  if (largest > s.cell)
    problems.push_back(problem("cell", "is smaller than the largest grain",
                               "cells of two diameters or more hold several grains; for smaller "
                               "ones there is the resolved coupling"));
  if (!(s.least_void_fraction > 0.0))
    problems.push_back(problem("least_void_fraction", "must be positive", "0.05 is usual"));
  return problems;
}

UnresolvedFlow::UnresolvedFlow(const Communicator& ranks, const UnresolvedSettings& settings)
    : ranks_(ranks),
      settings_(settings),
      drag_(law_named<DragLaw>(settings.drag)),
      flow_(make_flow(ranks, lattice_of(settings))),
      fields_(&flow_->average()) {
  if (auto problems = problems_of(settings, 0.0); !problems.empty())
    throw ConfigError(std::move(problems));
}

std::int64_t UnresolvedFlow::local(int axis, std::int64_t cell) const {
  return cell - flow_->blocks().low(axis);
}

UnresolvedFlow::Aim UnresolvedFlow::aim_of(const GrainInFlow& grain, const PoreState& pore) const {
  FluidPoint at;
  at.fluid = settings_.fluid;
  at.diameter = 2.0 * grain.radius;
  at.slip = pore.velocity - grain.velocity;
  at.void_fraction = pore.void_fraction;
  const double factor = std::visit(
      [&](const auto& law) { return law.factor(at.reynolds(), at.void_fraction); }, drag_);
  double coefficient =
      settings_.drag_amplitude * 3.0 * std::numbers::pi * at.fluid.viscosity * at.diameter * factor;
  Aim aim;
  if (settings_.model == ExchangeModel::kB) coefficient /= at.void_fraction;
  if (settings_.model == ExchangeModel::kA)
    aim.pressure_force = pressure_force(at, pore.pressure_gradient);
  // Backward Euler: m (v' - v)/dt = c (u - v') + others, with v' solved for.
  const double dt = settings_.time_step;
  aim.coefficient = coefficient / (1.0 + coefficient * dt / grain.mass);
  aim.velocity = grain.velocity + (dt / grain.mass) * (grain.other_force + aim.pressure_force);
  return aim;
}

std::vector<UnresolvedFlow::Deposit> UnresolvedFlow::deliver(const std::vector<GrainInFlow>& grains,
                                                             const std::vector<Aim>& aims) {
  const CellBlocks& blocks = flow_->blocks();
  const double cell = settings_.cell;
  const double dt = settings_.time_step;
  const double mass = settings_.fluid.density * cell * cell * cell;
  std::vector<Bytes> out(static_cast<std::size_t>(ranks_.size()));
  const auto wrapped = [&](int axis, std::int64_t at) {
    const std::int64_t n = blocks.cells()[static_cast<std::size_t>(axis)];
    return (at % n + n) % n;
  };
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const GrainInFlow& grain = grains[g];
    Deposit deposit{};
    deposit.id = grain.id;
    deposit.index = static_cast<std::int64_t>(g);
    deposit.place = (1.0 / cell) * grain.position - Vec3{0.5, 0.5, 0.5};
    deposit.volume = 4.0 / 3.0 * std::numbers::pi * std::pow(grain.radius / cell, 3);
    if (!aims.empty()) {
      const Aim& aim = aims[g];
      deposit.drag = aim.coefficient * dt / mass;
      // Taken from the fluid: the grain's pressure force; given to it: its drag's pull.
      deposit.push = deposit.drag * (dt / cell) * aim.velocity -
                     (dt * dt / (mass * cell)) * aim.pressure_force;
    }
    const Kernel kernel(deposit.place, blocks);
    const auto owner = [&](std::int64_t y, std::int64_t z) {
      return blocks.owner_of(blocks.key(0, wrapped(1, y), wrapped(2, z)));
    };
    deposit.home = owner(kernel.axis(1).middle(), kernel.axis(2).middle());
    std::array<int, 9> sent{};
    std::size_t count = 0;
    for (const std::int64_t z : kernel.axis(2).cell)
      for (const std::int64_t y : kernel.axis(1).cell) {
        const int rank = owner(y, z);
        if (std::find(sent.begin(), sent.begin() + count, rank) != sent.begin() + count) continue;
        sent[count++] = rank;
        append_bytes(out[static_cast<std::size_t>(rank)], &deposit, 1);
      }
  }
  // In the order of ids, whoever sent them: sums over grains are then the same on any ranks.
  std::vector<std::pair<Deposit, int>> all;
  const std::vector<Bytes> in = ranks_.exchange_all(out);
  for (std::size_t from = 0; from < in.size(); ++from) {
    ByteReader reader(in[from]);
    while (!reader.empty())
      reader.take(&all.emplace_back(Deposit{}, static_cast<int>(from)).first, 1);
  }
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.first.id < b.first.id; });
  std::vector<Deposit> deposits;
  senders_.clear();
  for (const auto& [deposit, from] : all) {
    deposits.push_back(deposit);
    senders_.push_back(from);
  }
  return deposits;
}

void UnresolvedFlow::put_down(const std::vector<Deposit>& deposits, bool with_forces) {
  const CellBlocks& blocks = flow_->blocks();
  // The source keeps the void fraction of before until the new one is there.
  const auto each_cell = [&](const auto& visit) {
    for (std::int64_t z = 0; z < blocks.count(2); ++z)
      for (std::int64_t y = 0; y < blocks.count(1); ++y)
        for (std::int64_t x = 0; x < blocks.count(0); ++x) visit(x, y, z);
  };
  each_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
    fields_->at(Fields::kSource, x, y, z) = fields_->at(Fields::kVoid, x, y, z);
    fields_->at(Fields::kVoid, x, y, z) = 0.0;
  });
  for (const auto field : {Fields::kPushX, Fields::kPushY, Fields::kPushZ, Fields::kDrag})
    fields_->fill(field, 0.0);
  for (const Deposit& d : deposits)
    Kernel(d.place, blocks).each([&](std::int64_t x, std::int64_t y, std::int64_t z, double share) {
      const CellCounts& n = blocks.cells();
      x = (x + n[0]) % n[0];
      y = (y + n[1]) % n[1];
      z = (z + n[2]) % n[2];
      if (!blocks.owns(x, y, z)) return;
      y = local(1, y);
      z = local(2, z);
      fields_->at(Fields::kVoid, x, y, z) += share * d.volume;
      fields_->at(Fields::kDrag, x, y, z) += share * d.drag;
      fields_->at(Fields::kPushX, x, y, z) += share * d.push.x;
      fields_->at(Fields::kPushY, x, y, z) += share * d.push.y;
      fields_->at(Fields::kPushZ, x, y, z) += share * d.push.z;
    });
  each_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
    double& voids = fields_->at(Fields::kVoid, x, y, z);
    double& source = fields_->at(Fields::kSource, x, y, z);
    voids = 1.0 - voids;
    source = with_forces ? source - voids : 0.0;
  });
}

UnresolvedFlow::Sample UnresolvedFlow::sample(const Deposit& deposit) const {
  Sample sample{};
  sample.index = deposit.index;
  const std::int64_t n = flow_->blocks().cells()[0];
  Kernel(deposit.place, flow_->blocks())
      .each([&](std::int64_t x, std::int64_t y, std::int64_t z, double share) {
        x = (x + n) % n;
        y = local(1, y);
        z = local(2, z);
        sample.velocity += share * Vec3{fields_->at(Fields::kVelocityX, x, y, z),
                                        fields_->at(Fields::kVelocityY, x, y, z),
                                        fields_->at(Fields::kVelocityZ, x, y, z)};
        sample.void_fraction += share * fields_->at(Fields::kVoid, x, y, z);
        sample.pressure_gradient += share * Vec3{fields_->at(Fields::kGradientX, x, y, z),
                                                 fields_->at(Fields::kGradientY, x, y, z),
                                                 fields_->at(Fields::kGradientZ, x, y, z)};
      });
  return sample;
}

std::vector<PoreState> UnresolvedFlow::pores_of(const std::vector<Deposit>& deposits,
                                                std::size_t grains) {
  fields_->exchange(ranks_, flow_->blocks(), {Fields::kPressure});
  fields_->differentiate(flow_->blocks());
  fields_->exchange(ranks_, flow_->blocks(),
                    {Fields::kVoid, Fields::kVelocityX, Fields::kVelocityY, Fields::kVelocityZ,
                     Fields::kGradientX, Fields::kGradientY, Fields::kGradientZ});
  std::vector<Bytes> out(static_cast<std::size_t>(ranks_.size()));
  for (std::size_t k = 0; k < deposits.size(); ++k) {
    if (deposits[k].home != ranks_.rank()) continue;
    const Sample found = sample(deposits[k]);
    append_bytes(out[static_cast<std::size_t>(senders_[k])], &found, 1);
  }
  const double speed = settings_.cell / settings_.time_step;
  const double gradient = settings_.fluid.density * speed * speed / settings_.cell;
  std::vector<PoreState> pores(grains);
  for (const Bytes& message : ranks_.exchange_all(out)) {
    ByteReader reader(message);
    while (!reader.empty()) {
      Sample found{};
      reader.take(&found, 1);
      pores[static_cast<std::size_t>(found.index)] = {
          speed * found.velocity, found.void_fraction,
          gradient * found.pressure_gradient - settings_.fluid.density * settings_.pressure_fall};
    }
  }
  return pores;
}

std::vector<PoreState> UnresolvedFlow::look(const std::vector<GrainInFlow>& grains) {
  const std::vector<Deposit> deposits = deliver(grains, {});
  put_down(deposits, false);
  if (const double least = least_void_fraction(); least < settings_.least_void_fraction)
    throw ConfigError({problem("cell", "a cell has a void fraction of " + std::to_string(least),
                               "grains fill it; take larger cells, or take grains out")});
  return pores_of(deposits, grains.size());
}

std::vector<Vec3> UnresolvedFlow::step(const std::vector<GrainInFlow>& grains,
                                       std::vector<PoreState>& pores) {
  std::vector<Aim> aims;
  for (std::size_t g = 0; g < grains.size(); ++g) aims.push_back(aim_of(grains[g], pores[g]));
  const std::vector<Deposit> deposits = deliver(grains, aims);
  put_down(deposits, true);
  flow_->step();
  pores = pores_of(deposits, grains.size());
  std::vector<Vec3> forces;
  for (std::size_t g = 0; g < grains.size(); ++g)
    forces.push_back(aims[g].coefficient * (pores[g].velocity - aims[g].velocity) +
                     aims[g].pressure_force);
  return forces;
}

double UnresolvedFlow::least_void_fraction() const {
  const CellBlocks& blocks = flow_->blocks();
  double least = 1.0;
  for (std::int64_t z = 0; z < blocks.count(2); ++z)
    for (std::int64_t y = 0; y < blocks.count(1); ++y)
      for (std::int64_t x = 0; x < blocks.count(0); ++x)
        least = std::min(least, fields_->at(Fields::kVoid, x, y, z));
  return -ranks_.max(-least);
}

double UnresolvedFlow::void_fraction(std::int64_t x, std::int64_t y, std::int64_t z) const {
  return fields_->at(Fields::kVoid, x, local(1, y), local(2, z));
}

Vec3 UnresolvedFlow::velocity(std::int64_t x, std::int64_t y, std::int64_t z) const {
  y = local(1, y);
  z = local(2, z);
  return (settings_.cell / settings_.time_step) * Vec3{fields_->at(Fields::kVelocityX, x, y, z),
                                                       fields_->at(Fields::kVelocityY, x, y, z),
                                                       fields_->at(Fields::kVelocityZ, x, y, z)};
}

double UnresolvedFlow::pressure(std::int64_t x, std::int64_t y, std::int64_t z) const {
  const double speed = settings_.cell / settings_.time_step;
  return settings_.fluid.density * speed * speed *
         fields_->at(Fields::kPressure, x, local(1, y), local(2, z));
}

// The populations' own: the flow's totals have half of the uniform force besides.
Vec3 UnresolvedFlow::momentum() const {
  const FlowTotals totals = flow_->totals();
  const Vec3 half = (0.5 * totals.cells) * lattice_of(settings_).force_lu;
  const double cell = settings_.cell;
  return (settings_.fluid.density * std::pow(cell, 4) / settings_.time_step) *
         (totals.momentum_lu - half);
}

double UnresolvedFlow::mach() const { return flow_->totals().max_speed_lu * std::sqrt(3.0); }

void UnresolvedFlow::save_state(State& state, const StatePiece& piece) const {
  flow_->save_state(state, piece);
  const CellBlocks& blocks = flow_->blocks();
  const CellCounts& n = blocks.cells();
  StateTable table;
  table.name = kTable;
  table.real_fields = {{"void_fraction", "1", 1}};
  table.key_count = table.all_rows = n[0] * n[1] * n[2];
  for (std::int64_t z = blocks.low(2); z < blocks.high(2); ++z)
    for (std::int64_t y = blocks.low(1); y < blocks.high(1); ++y)
      for (std::int64_t x = 0; x < n[0]; ++x) {
        const std::int64_t key = blocks.key(x, y, z);
        if (!piece.has(key, table.key_count)) continue;
        table.integers.insert(table.integers.end(), {key, 0});
        table.reals.push_back(void_fraction(x, y, z));
      }
  state.push_back(std::move(table));
}

void UnresolvedFlow::begin_load() { flow_->begin_load(); }

void UnresolvedFlow::load_rows(const StateTable& rows) {
  flow_->load_rows(rows);
  if (rows.name != kTable) return;
  const CellBlocks& blocks = flow_->blocks();
  const CellCounts& n = blocks.cells();
  if (rows.real_width() != 1 || rows.key_count != n[0] * n[1] * n[2])
    throw FormatError("the checkpoint's void fractions are of another lattice");
  std::vector<Bytes> out(static_cast<std::size_t>(ranks_.size()));
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    const std::int64_t key = rows.integers[row * rows.integer_width()];
    Bytes& to = out[static_cast<std::size_t>(blocks.owner_of(key))];
    append_bytes(to, &key, 1);
    append_bytes(to, &rows.reals[row], 1);
  }
  for (const Bytes& message : ranks_.exchange_all(out)) {
    ByteReader reader(message);
    while (!reader.empty()) {
      std::int64_t key = 0;
      double value = 0.0;
      reader.take(&key, 1);
      reader.take(&value, 1);
      fields_->at(Fields::kVoid, key % n[0], local(1, key / n[0] % n[1]),
                  local(2, key / (n[0] * n[1]))) = value;
    }
  }
}

}  // namespace grouser
