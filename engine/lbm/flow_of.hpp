// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "base/check.hpp"
#include "base/errors.hpp"
#include "engine/lbm/flow.hpp"
#include "engine/lbm/open_faces.hpp"
#include "engine/lbm/population_halo.hpp"
#include "engine/lbm/sweep_averaged.hpp"
#include "engine/lbm/sweep_rows.hpp"
#include "engine/lbm/wall_links_impl.hpp"

namespace grouser {

/// A flow on lattice Set with populations of type Real.
template <class Set, class Real>
class FlowOf final : public Flow {
 public:
  FlowOf(const Communicator& ranks, const FlowSettings& settings)
      : ranks_(ranks),
        blocks_(settings.cells, periodic_axes(settings), ranks),
        box_{blocks_.count(0), blocks_.count(1), blocks_.count(2), Set::kDimensions == 3 ? 1 : 0},
        force_(settings.force_lu),
        collision_(make_collision<Real>(settings.collision, settings.parameters)),
        streaming_(box_, blocks_.periodic(0)),
        halo_(ranks, blocks_),
        solids_(settings, blocks_, box_),
        immersed_(blocks_, box_, settings.parameters.viscosity_lu),
        walls_(settings, blocks_, solids_, box_),
        open_(settings, blocks_, solids_, box_) {
    const auto add_rows = [&](bool outer) {
      for (std::int64_t z = 0; z < box_.nz; ++z)
        for (std::int64_t y = 0; y < box_.ny; ++y)
          if (at_face(y, z) == outer) add_row(y, z);
    };
    add_rows(true);
    outer_rows_ = rows_.size();
    add_rows(false);
  }

  void step() override {
    const Parity due = streaming_.parity();
    const Parity next = due == Parity::kEven ? Parity::kOdd : Parity::kEven;
    if (due == Parity::kEven) quieten_dead_cells();
    immersed_.clear_loads();
    // Rows next to faces first: what they sent travels while the others are swept.
    sweep_part(0, outer_rows_);
    const std::size_t inner = rows_.size() - outer_rows_;
    std::size_t from = outer_rows_;
    for (int stage = 0; stage < Halo::kAxes; ++stage) {
      const std::size_t to = outer_rows_ + inner * static_cast<std::size_t>(stage + 1) /
                                               static_cast<std::size_t>(Halo::kAxes);
      streaming_.set_parity(next);
      halo_.begin(streaming_, stage);
      streaming_.set_parity(due);
      sweep_part(from, to);
      from = to;
      streaming_.set_parity(next);
      halo_.end(streaming_);
    }
    walls_.apply(streaming_);
    open_.apply(streaming_, force_);
    ++steps_;
  }

  void set_equilibrium(const std::function<FlowNode(const Vec3&)>& at) override {
    streaming_.set_parity(Parity::kEven);
    each_fluid_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
      const FlowNode node = at(centre_of(blocks_, x, y, z));
      const Vec3& u = node.velocity_lu;
      for (std::size_t i = 0; i < Set::kVelocities; ++i) {
        const LatticeVelocity c = Set::kSet.velocities[i];
        const double cu = c.x * u.x + c.y * u.y + c.z * u.z;
        // Half of the first step's force has not yet acted.
        const double push = c.x * force_.x + c.y * force_.y + c.z * force_.z;
        *streaming_.arriving(i, x, y, z) = static_cast<Real>(
            Set::kSet.weights[i] * (node.density_lu - 1.0 - 1.5 * push +
                                    node.density_lu * (3.0 * cu + 4.5 * cu * cu - 1.5 * norm2(u))));
      }
    });
  }

  void set_force(const Vec3& force_lu) override { force_ = force_lu; }
  void set_face_velocity(int axis, int end, const Vec3& velocity_lu) override {
    walls_.set_face_velocity(axis, end, velocity_lu);
    open_.set_velocity(axis, end, velocity_lu);
  }

  FlowNode node(std::int64_t x, std::int64_t y, std::int64_t z) const override {
    GROUSER_CHECK(blocks_.owns(x, y, z));
    return local_node(x - blocks_.low(0), y - blocks_.low(1), z - blocks_.low(2));
  }
  double population(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const override {
    GROUSER_CHECK(blocks_.owns(x, y, z));
    return *streaming_.arriving(i, x - blocks_.low(0), y - blocks_.low(1), z - blocks_.low(2));
  }
  bool is_fluid(std::int64_t x, std::int64_t y, std::int64_t z) const override {
    return solids_.is_fluid(x - blocks_.low(0), y - blocks_.low(1), z - blocks_.low(2));
  }

  FlowTotals totals() const override {
    Communicator::StepTotals sums;
    sums.sums.resize(4);
    double fastest = 0.0;
    std::int64_t cells = 0;
    bool finite = true;
    each_fluid_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
      const FlowNode node = local_node(x, y, z);
      const Vec3& u = node.velocity_lu;
      const double terms[4] = {node.density_lu - 1.0, node.density_lu * u.x, node.density_lu * u.y,
                               node.density_lu * u.z};
      finite = finite && std::isfinite(terms[0] + terms[1] + terms[2] + terms[3]);
      ++cells;
      if (!finite) return;
      for (std::size_t k = 0; k < 4; ++k) sums.sums[k].add(terms[k]);
      fastest = std::max(fastest, norm(u));
    });
    sums.maxima = {fastest, finite ? 0.0 : 1.0};
    ranks_.combine(sums);
    FlowTotals totals;
    totals.cells = static_cast<double>(ranks_.sum(cells));
    totals.excess_lu = sums.sums[0].value();
    totals.momentum_lu = {sums.sums[1].value(), sums.sums[2].value(), sums.sums[3].value()};
    totals.max_speed_lu = sums.maxima[0];
    totals.finite = sums.maxima[1] == 0.0;
    return totals;
  }

  std::vector<FluidLoad> loads() const override {
    Communicator::StepTotals sums;
    for (const auto& surface : walls_.loads(streaming_)) {
      sums.sums.insert(sums.sums.end(), surface.force.begin(), surface.force.end());
      sums.sums.insert(sums.sums.end(), surface.moment.begin(), surface.moment.end());
    }
    ranks_.combine(sums);
    std::vector<FluidLoad> loads(walls_.surfaces());
    for (std::size_t s = 0; s < loads.size(); ++s) {
      const ExactSum* six = &sums.sums[6 * s];
      loads[s] = {{six[0].value(), six[1].value(), six[2].value()},
                  {six[3].value(), six[4].value(), six[5].value()}};
    }
    return loads;
  }

  AveragedFields& average() override {
    if constexpr (kMayBeAveraged) {
      if (!averaged_ && std::holds_alternative<TwoRates<double>>(collision_))
        averaged_ = std::make_unique<AveragedFields>(box_);
      if (averaged_) return *averaged_;
    }
    throw ConfigError({Problem{"", 0, 0, "lattice", "cannot hold a volume-averaged flow",
                               "take D3Q19 with trt in double precision"}});
  }

  void immerse(const std::vector<ImmersedBall>& balls,
               const std::vector<ImmersedBody>& bodies) override {
    if (Set::kDimensions != 3 && !(balls.empty() && bodies.empty()))
      throw ConfigError({Problem{"", 0, 0, "lattice", "is flat and holds no solids", "D3Q19"}});
    immersed_.immerse(balls, bodies);
  }
  const std::vector<ImmersedLoad>& immersed_loads() const override { return immersed_.loads(); }

  const CellBlocks& blocks() const override { return blocks_; }
  std::int64_t steps() const override { return steps_; }
  std::size_t bytes() const override {
    return streaming_.populations().bytes() + solids_.bytes() + walls_.bytes() + immersed_.bytes() +
           rows_.capacity() * sizeof(Row) + spans_.capacity() * sizeof(Span) +
           (averaged_ ? averaged_->bytes() : 0);
  }

  void save_state(State& state, const StatePiece& piece) const override;
  void begin_load() override;
  void load_rows(const StateTable& rows) override;
  void end_load() override;

 private:
  using Halo = PopulationHalo<Set, Real>;
  static constexpr bool kMayBeAveraged = std::is_same_v<Set, D3Q19> && std::is_same_v<Real, double>;

  static std::array<bool, 3> periodic_axes(const FlowSettings& settings) {
    std::array<bool, 3> periodic{};
    for (std::size_t a = 0; a < 3; ++a)
      periodic[a] = settings.faces[a][0].kind == FaceKind::kPeriodic;
    return periodic;
  }

  template <class Visit>
  void each_fluid_cell(const Visit& visit) const {
    for (std::int64_t z = 0; z < box_.nz; ++z)
      for (std::int64_t y = 0; y < box_.ny; ++y)
        for (std::int64_t x = 0; x < box_.nx; ++x)
          if (solids_.is_fluid(x, y, z)) visit(x, y, z);
  }

  bool at_face(std::int64_t y, std::int64_t z) const {
    return y == 0 || y + 1 == box_.ny || (box_.ghosts_z > 0 && (z == 0 || z + 1 == box_.nz));
  }

  // Whole registers from the first to the last cell of fluid of each stretch.
  void add_row(std::int64_t y, std::int64_t z) {
    constexpr auto kLanes = static_cast<std::int64_t>(WideOf<Real>::kLanes);
    const Populations<Real>& populations = streaming_.populations();
    Row row{populations.at(0, y, z), spans_.size(), 0};
    for (std::int64_t x = 0; x < box_.nx; x += kLanes) {
      bool fluid = false;
      for (std::int64_t lane = x; lane < x + kLanes; ++lane) {
        const bool here = lane < box_.nx && solids_.is_fluid(lane, y, z);
        fluid = fluid || here;
        if (!here) dead_.push_back(static_cast<std::int32_t>(populations.at(lane, y, z)));
      }
      if (!fluid) {
        dead_.resize(dead_.size() - kLanes);
        continue;
      }
      if (row.spans > 0 && spans_.back().begin + spans_.back().length == row.begin + x) {
        spans_.back().length += kLanes;
      } else {
        spans_.push_back({row.begin + x, kLanes});
        ++row.spans;
      }
    }
    rows_.push_back(row);
  }

  // Cells that share a register with fluid are collided with it though they are none. Nothing
  // they do reaches fluid, but left alone for long they might overflow.
  void quieten_dead_cells() {
    for (std::size_t i = 0; i < Set::kVelocities && !dead_.empty(); ++i) {
      Real* const first = streaming_.populations().of(i);
      for (const std::int32_t cell : dead_) first[cell] = Real(0);
    }
  }

  void sweep_part(std::size_t from, std::size_t to) {
    const SweepRange range{rows_.data() + from, to - from, spans_.data(), streaming_.period_x()};
    if constexpr (kMayBeAveraged) {
      if (averaged_) {
        sweep_averaged(streaming_, std::get<TwoRates<double>>(collision_), force_, range,
                       *averaged_);
        return;
      }
    }
    if constexpr (Set::kDimensions == 3) {
      if (!immersed_.empty()) {
        sweep_immersed_rows<Set, Real>(streaming_, collision_, force_, range, solids_, immersed_);
        return;
      }
    }
    sweep_rows<Set, Real>(streaming_, collision_, force_, range);
  }

  FlowNode local_node(std::int64_t x, std::int64_t y, std::int64_t z) const {
    double excess = 0.0;
    Vec3 momentum = 0.5 * force_;
    for (std::size_t i = 0; i < Set::kVelocities; ++i) {
      const double f = *streaming_.arriving(i, x, y, z);
      const LatticeVelocity c = Set::kSet.velocities[i];
      excess += f;
      momentum += {c.x * f, c.y * f, c.z * f};
    }
    return {1.0 + excess, (1.0 / (1.0 + excess)) * momentum};
  }

  Communicator ranks_;
  CellBlocks blocks_;
  CellBox box_;
  Vec3 force_;
  Collision<Real> collision_;
  Streaming<Set, Real> streaming_;
  Halo halo_;
  SolidMap solids_;
  ImmersedRows<Real> immersed_;
  WallLinks<Set, Real> walls_;
  OpenFaces<Set, Real> open_;
  std::unique_ptr<AveragedFields> averaged_;
  std::vector<Row> rows_;
  std::size_t outer_rows_ = 0;  // of rows_, those at faces of the block
  std::vector<Span> spans_;
  std::vector<std::int32_t> dead_;
  std::int64_t steps_ = 0;
  std::string load_failure_;
  std::int64_t loaded_ = 0;
};

// Rows are keyed by cell and hold what arrives at it, so that the state is the same after an even
// and an odd number of steps.
template <class Set, class Real>
void FlowOf<Set, Real>::save_state(State& state, const StatePiece& piece) const {
  const std::int64_t keys = blocks_.cells()[0] * blocks_.cells()[1] * blocks_.cells()[2];
  StateTable table;
  table.name = "populations";
  table.real_fields = {{"population", "1", static_cast<int>(Set::kVelocities)}};
  table.key_count = keys;
  std::int64_t all = 0;
  const std::int64_t begin = piece.begin(keys);
  const std::int64_t end = piece.end(keys);
  for (std::int64_t z = 0; z < box_.nz; ++z)
    for (std::int64_t y = 0; y < box_.ny; ++y)
      for (std::int64_t x = 0; x < box_.nx; ++x) {
        if (!solids_.is_fluid(x, y, z)) continue;
        ++all;
        const std::int64_t key =
            blocks_.key(x + blocks_.low(0), y + blocks_.low(1), z + blocks_.low(2));
        if (key < begin || key >= end) continue;
        table.integers.insert(table.integers.end(), {key, 0});
        for (std::size_t i = 0; i < Set::kVelocities; ++i)
          table.reals.push_back(*streaming_.arriving(i, x, y, z));
      }
  table.all_rows = ranks_.sum(all);

  StateTable clock;
  clock.name = "flow";
  clock.key_count = clock.all_rows = 1;
  clock.real_fields = {{"steps", "1", 1}, {"force", "1", 3}};
  if (ranks_.rank() == 0 && piece.has(0, 1)) {
    clock.integers = {0, 0};
    clock.reals = {static_cast<double>(steps_), force_.x, force_.y, force_.z};
  }
  state.push_back(std::move(table));
  state.push_back(std::move(clock));
}

template <class Set, class Real>
void FlowOf<Set, Real>::begin_load() {
  streaming_.set_parity(Parity::kEven);
  loaded_ = 0;
  load_failure_.clear();
}

template <class Set, class Real>
void FlowOf<Set, Real>::load_rows(const StateTable& rows) {
  if (rows.name == "flow") {
    const std::vector<double> values = first_row(ranks_, rows);
    if (!std::isfinite(values[0])) return;  // a piece without the row
    steps_ = static_cast<std::int64_t>(values[0]);
    force_ = {values[1], values[2], values[3]};
  }
  if (rows.name != "populations") return;
  if (rows.real_width() != Set::kVelocities) {
    load_failure_ = "its lattice has other velocities";
    return;
  }
  const CellCounts& n = blocks_.cells();
  if (rows.key_count != n[0] * n[1] * n[2]) {
    load_failure_ = "its lattice has another number of cells";
    return;
  }
  // To the ranks that own the cells.
  std::vector<Bytes> out(static_cast<std::size_t>(ranks_.size()));
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    const std::int64_t key = rows.integers[row * rows.integer_width()];
    Bytes& to = out[static_cast<std::size_t>(blocks_.owner_of(key))];
    append_bytes(to, &key, 1);
    append_bytes(to, &rows.reals[row * Set::kVelocities], Set::kVelocities);
  }
  for (const Bytes& message : ranks_.exchange_all(out)) {
    ByteReader reader(message);
    while (!reader.empty()) {
      std::int64_t key = 0;
      std::array<double, Set::kVelocities> values;
      reader.take(&key, 1);
      reader.take(values.data(), values.size());
      const std::int64_t x = key % n[0] - blocks_.low(0);
      const std::int64_t y = key / n[0] % n[1] - blocks_.low(1);
      const std::int64_t z = key / (n[0] * n[1]) - blocks_.low(2);
      if (!solids_.is_fluid(x, y, z)) load_failure_ = "it has fluid where an obstacle is";
      for (std::size_t i = 0; i < Set::kVelocities; ++i)
        *streaming_.arriving(i, x, y, z) = static_cast<Real>(values[i]);
      ++loaded_;
    }
  }
}

template <class Set, class Real>
void FlowOf<Set, Real>::end_load() {
  std::int64_t fluid = 0;
  each_fluid_cell([&](std::int64_t, std::int64_t, std::int64_t) { ++fluid; });
  if (load_failure_.empty() && fluid != loaded_) load_failure_ = "cells of fluid are missing";
  if (ranks_.max(std::int64_t{load_failure_.empty() ? 0 : 1}) == 0) return;
  throw FormatError("the checkpoint does not fit the flow: " +
                    (load_failure_.empty() ? "see another rank" : load_failure_));
}

}  // namespace grouser
