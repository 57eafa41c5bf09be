// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/coupling/laws/gradient.hpp"
#include "engine/coupling/laws/table.hpp"
#include "engine/coupling/void_kernel.hpp"
#include "engine/lbm/flow.hpp"

namespace grouser {

/// Which equations share the pressure: in A it acts on fluid and grains by their volumes, in B on
/// the fluid alone, and drag is 1/n times as large. In a steady bed they are the same.
enum class ExchangeModel { kA, kB };

struct UnresolvedSettings {
  /// Cells, faces and obstacles; viscosity and body force are made from the fluid's.
  FlowSettings lattice;
  double cell = 0.0;       ///< side of a cell [m]
  double time_step = 0.0;  ///< of the lattice [s]
  Fluid fluid;
  std::string drag = "di_felice_brown_lawler";
  double drag_amplitude = 1.0;
  ExchangeModel model = ExchangeModel::kA;
  /// A uniform fall of the pressure beside what the lattice finds, over the fluid's density, which
  /// drives flow through a periodic lattice [m s-2].
  Vec3 pressure_fall;
  double least_void_fraction = 0.05;  ///< a cell with less is refused [1]
};

/// The fluid where a grain is, as its owner last heard.
struct PoreState {
  Vec3 velocity;               ///< between the grains [m s-1]
  double void_fraction = 1.0;  ///< [1]
  Vec3 pressure_gradient;      ///< beyond that of the fluid at rest [Pa m-1]
};

/// A grain as a volume-averaged flow sees it.
struct GrainInFlow {
  std::int64_t id = 0;
  Vec3 position;  ///< from the lattice's lower corner [m]
  Vec3 velocity;  ///< [m s-1]
  double radius = 0.0;
  double mass = 0.0;
  Vec3 other_force;  ///< of all but the fluid, when last known [N]
};

/// A fluid on a lattice whose cells are larger than the grains, and the drag between the two
/// (AveragedFields has the equations).
///
/// Forces are exchanged to rounding: what grains are given is taken from the fluid of the cells
/// around them. Both sides of the drag are implicit: the fluid's as that of the cell, the grain's
/// by backward Euler, with the law's coefficient of the step before. First order in the time step.
/// Pressure is that beyond the fluid at rest, so buoyancy is not in it. Neglected: lift, added
/// mass, history, torque; velocity fluctuations below the cell; what a grain's own share does to
/// the fluid that it feels, which matters for a lone grain about as large as its cell.
class UnresolvedFlow : public Stateful {
 public:
  /// A fluid at rest without grains. @throws ConfigError. Collective.
  UnresolvedFlow(const Communicator& ranks, const UnresolvedSettings& settings);

  /// What is wrong with the settings. @param largest diameter of a grain [m]. Local.
  static std::vector<Problem> problems_of(const UnresolvedSettings& settings, double largest);

  /// Tells grains where they are, before the first step.
  /// @param grains of this rank, in any order; those of all ranks are all there are
  /// @throws ConfigError on every rank when a cell has less than the least void fraction.
  /// Collective.
  std::vector<PoreState> look(const std::vector<GrainInFlow>& grains);

  /// One step of the lattice. Collective.
  /// @param pores   of each grain, as look() or the step before said; renewed
  /// @return force of the fluid on each grain over the step, without buoyancy [N]
  std::vector<Vec3> step(const std::vector<GrainInFlow>& grains, std::vector<PoreState>& pores);

  /// Least void fraction of a cell, on all ranks. Collective.
  double least_void_fraction() const;
  /// Void fraction, velocity and pressure of a cell of this rank. Local.
  double void_fraction(std::int64_t x, std::int64_t y, std::int64_t z) const;
  Vec3 velocity(std::int64_t x, std::int64_t y, std::int64_t z) const;    ///< [m s-1]
  double pressure(std::int64_t x, std::int64_t y, std::int64_t z) const;  ///< [Pa]
  /// Momentum of all fluid [N s]. Collective.
  Vec3 momentum() const;
  /// Largest speed over that of sound. Collective.
  double mach() const;
  Flow& flow() { return *flow_; }
  const Flow& flow() const { return *flow_; }

  void save_state(State& state, const StatePiece& piece = {}) const override;
  void begin_load() override;
  void load_rows(const StateTable& rows) override;
  void end_load() override { flow_->end_load(); }

 private:
  // A grain on its way to those ranks that have cells of it, in lattice units.
  struct Deposit {
    std::int64_t id;
    std::int64_t index;  // of the sender's list
    std::int64_t home;   // rank that owns the cell of its centre
    Vec3 place;
    double volume;
    double drag;
    Vec3 push;
  };
  struct Sample {
    std::int64_t index;
    Vec3 velocity;
    double void_fraction;
    Vec3 pressure_gradient;
  };
  // What a grain's drag is in the step: coefficient and the velocity that it is aimed at [m s-1].
  struct Aim {
    double coefficient = 0.0;  // [N s m-1]
    Vec3 velocity;
    Vec3 pressure_force;  // [N]
  };

  Aim aim_of(const GrainInFlow& grain, const PoreState& pore) const;
  std::vector<Deposit> deliver(const std::vector<GrainInFlow>& grains,
                               const std::vector<Aim>& aims);
  void put_down(const std::vector<Deposit>& deposits, bool with_forces);
  std::vector<PoreState> pores_of(const std::vector<Deposit>& deposits, std::size_t grains);
  Sample sample(const Deposit& deposit) const;
  std::int64_t local(int axis, std::int64_t cell) const;

  Communicator ranks_;
  UnresolvedSettings settings_;
  DragLaw drag_;
  std::unique_ptr<Flow> flow_;
  AveragedFields* fields_;
  std::vector<int> senders_;  // of each deposit, in order
};

}  // namespace grouser
