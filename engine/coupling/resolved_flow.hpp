// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "base/lattice_units.hpp"
#include "engine/core/state_io.hpp"
#include "engine/dem/world.hpp"
#include "engine/lbm/flow.hpp"

namespace grouser {

/// The flow that a case's lattice describes, in lattice units. Local.
FlowSettings flow_settings(const Case& input);

/// Fluid on a lattice around grains and what it does to them: docs/physics/coupling.md.
///
/// Once in so many steps of the grains they are mapped anew, the fluid makes its step around them,
/// and the force and torque it gave them act on them until the next. A grain's inertia is its own:
/// what the fluid inside it takes to be accelerated, which the exchange contains, is given back
/// with the grain's acceleration of the step before (Feng, Michaelides 2009). Momentum of grains
/// and fluid, less that of fluid inside grains, is kept to rounding. The same goes for a body that
/// turns, the wheel, whose cells are covered as its surface says. Neglected: lubrication in gaps
/// below a cell; the surface of the fluid moves as a slipping lid would.
class ResolvedFlow : public Stateful {
 public:
  /// @param world whose grains they are; must outlive this. Collective.
  ResolvedFlow(const Case& input, const World& world);

  /// Steps the fluid if it is due before the grains' step `step`, counted from 0. Collective.
  void advance(std::int64_t step);

  /// Force and torque of the fluid in motion on an owned grain [N], [N m]; the fluid's pressure at
  /// rest is not in it. Local.
  GrainLoad load(std::int64_t id) const;
  /// Number of the body that turns, and what the fluid does to it, buoyancy included; none without.
  std::optional<std::size_t> wheel() const { return wheel_; }
  BodyLoad wheel_load() const;
  /// Share of a ball that lies below the fluid's surface. Local.
  double wet_share(const Particle& p) const;

  /// See GrainForces.
  void give(std::int64_t id, Bytes& to);
  void take(std::int64_t id, ByteReader& from);

  const Flow& flow() const { return *flow_; }
  const LatticeScale& scale() const { return scale_; }

  void save_state(State& state, const StatePiece& piece = {}) const override;
  void begin_load() override;
  void load_rows(const StateTable& rows) override;
  void end_load() override { flow_->end_load(); }

 private:
  // What acts on a grain until the next step of the fluid, and how it moved at the last.
  struct Held {
    Vec3 force;
    Vec3 moment;
    Vec3 velocity;
    Vec3 spin;
  };
  // A grain on its way to the ranks whose cells it covers.
  struct Sent {
    std::int64_t id;
    std::int64_t place;  // in the sender's grains
    ImmersedBall ball;
  };

  ImmersedBall ball_of(const Particle& p) const;
  ImmersedBody wheel_body() const;
  void hold_wheel(const ImmersedLoad& load);
  std::vector<Bytes> send_grains() const;
  void receive_loads(const std::vector<Bytes>& answers);
  void hold(const Particle& p, const ImmersedLoad& load);

  const World& world_;
  LatticeScale scale_;
  double magic_;
  double density_;
  double height_;
  double lift_;  // of buoyancy, on a volume [N m-3]
  std::unique_ptr<Flow> flow_;
  std::optional<std::size_t> wheel_;
  Held wheel_held_;  // velocity and spin of the wheel's axle
  bool wheel_moved_ = false;
  std::unordered_map<std::int64_t, Held> held_;  // by grain, of this rank's
};

}  // namespace grouser
