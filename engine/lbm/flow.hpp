// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "engine/core/state_io.hpp"
#include "engine/lbm/averaged.hpp"
#include "engine/lbm/cell_blocks.hpp"
#include "engine/lbm/collision.hpp"
#include "engine/lbm/immersed.hpp"

namespace grouser {

inline constexpr std::array<const char*, 4> kLattices = {"D2Q9", "D3Q15", "D3Q19", "D3Q27"};

/// How many bytes a population takes, in memory and in arithmetic.
enum class Precision { kDouble, kSingle };

/// What fluid meets at one side of the lattice. Cells have their centres at whole numbers from 0 to
/// n - 1.
enum class FaceKind {
  kPeriodic,  ///< both sides of an axis or none
  kWall,      ///< half a cell beyond the last centre; fluid sticks to it
  kSlip,      ///< half a cell beyond the last centre; it takes no tangential force
  kVelocity,  ///< the last centres have a given velocity
  kPressure,  ///< the last centres have a given density; velocity there is normal to the face
  kOutflow    ///< nothing changes across the last cell
};

struct Face {
  FaceKind kind = FaceKind::kPeriodic;
  Vec3 velocity_lu{};       ///< of a wall [cells per step], or of the fluid at kVelocity
  double density_lu = 1.0;  ///< at kPressure; the pressure is a third of it
  /// At kVelocity in place of velocity_lu where the velocity changes over the face; of a centre.
  std::function<Vec3(const Vec3&)> profile{};
};

/// A solid body in the fluid.
struct Obstacle {
  /// Distance of a point from its surface [cells], negative inside; may be any smooth function of
  /// the same sign that grows across the surface.
  std::function<double(const Vec3&)> distance;
  /// Half-way bounce-back takes the surface to lie half-way between centres; else it is put where
  /// `distance` says (Bouzidi, Firdaouss, Lallemand 2001), which is of second order.
  bool interpolated = false;
  Vec3 velocity_lu{};
  Vec3 spin_lu{};  ///< [rad per step], about `centre`
  Vec3 centre{};
};

struct FlowSettings {
  std::string lattice = "D3Q19";  ///< one of kLattices
  std::string collision = "trt";  ///< one of kCollisions
  Precision precision = Precision::kDouble;
  CollisionParameters parameters;
  CellCounts cells{1, 1, 1};  ///< along x, y, z; a flat lattice has one along z
  /// Low and high end of x, y, z.
  std::array<std::array<Face, 2>, 3> faces{};
  Vec3 force_lu{};  ///< body force density
  std::vector<Obstacle> obstacles;
};

/// Density and velocity of a cell, at the time between two steps (half of the force included).
struct FlowNode {
  double density_lu = 1.0;
  Vec3 velocity_lu{};
};

/// Sums over all cells of fluid. Exact, so the same on any number of ranks.
struct FlowTotals {
  double cells = 0.0;
  double excess_lu = 0.0;  ///< mass beyond that of the fluid at rest
  Vec3 momentum_lu{};
  double max_speed_lu = 0.0;  ///< largest velocity
  bool finite = true;         ///< whether no number was lost
};

/// What the fluid did to one body or face in the last step.
struct FluidLoad {
  Vec3 force_lu{};   ///< without the pressure of the fluid at rest
  Vec3 moment_lu{};  ///< about the body's centre; about the origin for a face
};

/// Fluid on a lattice, spread over ranks. The trajectory is the same bit for bit on any number of
/// ranks.
class Flow : public Stateful {
 public:
  /// One step: collision and streaming. Collective.
  virtual void step() = 0;

  /// Sets every cell of fluid to the equilibrium of what `at` says of its centre. Collective.
  virtual void set_equilibrium(const std::function<FlowNode(const Vec3&)>& at) = 0;
  virtual void set_force(const Vec3& force_lu) = 0;
  /// Replaces the profile, where there was one. Collective, with the same value on every rank.
  virtual void set_face_velocity(int axis, int end, const Vec3& velocity_lu) = 0;

  /// State of a cell that this rank owns. Local.
  virtual FlowNode node(std::int64_t x, std::int64_t y, std::int64_t z) const = 0;
  /// What arrived at that cell along velocity i, without its weight at rest. Local.
  virtual double population(std::size_t i, std::int64_t x, std::int64_t y,
                            std::int64_t z) const = 0;
  virtual bool is_fluid(std::int64_t x, std::int64_t y, std::int64_t z) const = 0;
  virtual FlowTotals totals() const = 0;  ///< Collective.
  /// Loads on obstacles, then on the faces in the order of FlowSettings; those that are not walls
  /// have none. Momentum exchange over the links cut by the surface, in the form that does not
  /// depend on the observer's speed (Wen, Zhang, Tu, Wang, Fang 2014). Collective.
  virtual std::vector<FluidLoad> loads() const = 0;

  /// Makes this the volume-averaged flow between grains and gives what it shares with them, which
  /// the caller fills before each step. Void fractions are no part of the flow's state; node() is
  /// of the momentum n u. Moving walls and open faces are for cells without grains.
  /// @throws ConfigError but for D3Q19 with bgk or trt in double precision. Local.
  virtual AveragedFields& average() = 0;

  /// Puts solids into the fluid in place of those before; they stay until the next call, as they
  /// are. Each rank names all that may cover its cells, and others as it likes. What they are given
  /// is momentum exchange of the immersed moving boundary; the fluid inside them is fluid.
  /// @throws ConfigError on a flat lattice. Local.
  virtual void immerse(const std::vector<ImmersedBall>& balls,
                       const std::vector<ImmersedBody>& bodies) = 0;
  void immerse(const std::vector<ImmersedBall>& balls) { immerse(balls, {}); }
  /// What the fluid gave each of them in this rank's cells in the last step: balls, then bodies.
  /// Local.
  virtual const std::vector<ImmersedLoad>& immersed_loads() const = 0;

  virtual const CellBlocks& blocks() const = 0;
  virtual std::int64_t steps() const = 0;
  /// Memory of this rank [byte].
  virtual std::size_t bytes() const = 0;
};

/// A flow at rest. @throws ConfigError naming every setting that makes no sense. Collective.
std::unique_ptr<Flow> make_flow(const Communicator& ranks, const FlowSettings& settings);

/// What is wrong with the settings, nothing when they can be used. Local.
std::vector<Problem> problems_of(const FlowSettings& settings);

}  // namespace grouser
