// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/case.hpp"
#include "engine/core/state_io.hpp"
#include "engine/coupling/fluid_forces.hpp"
#include "engine/coupling/resolved_flow.hpp"
#include "engine/dem/world.hpp"

namespace grouser {

/// How the tracked grain moves in the middle of a step, and what makes it.
struct TrackRow {
  Vec3 position;        ///< [m]
  Vec3 velocity;        ///< [m s-1]
  Vec3 acceleration;    ///< [m s-2]
  Vec3 spin;            ///< [rad s-1]
  double gap = 0.0;     ///< lowest point over the floor [m]
  double reynolds = 0;  ///< 0 without a fluid [1]
  double contacts = 0;  ///< with other grains, floor and side walls [1]
  ForceParts parts;
};

/// Header of track.csv, without its line end.
std::string track_header();
/// The row's values in the order of the header, step and time aside.
std::vector<double> track_values(const TrackRow& row);

/// What a case has acting on grains beyond contacts and gravity: the fluid, probes; and the eye on
/// the tracked grain.
class OuterForces : public GrainForces, public Stateful {
 public:
  /// @param world whose grains they are; lets this act on them, and must not outlive it
  OuterForces(const Case& input, World& world);
  ~OuterForces() override;
  OuterForces(const OuterForces&) = delete;
  OuterForces& operator=(const OuterForces&) = delete;

  /// Whether a case has anything of this kind.
  static bool are_in(const Case& input);

  /// Says which step comes next and what time it begins at, and whether its motion of the tracked
  /// grain is wanted; a fluid on a lattice makes its step if it is due. Collective.
  void announce(std::int64_t step, double time, bool with_track);
  /// Adds the fluid's load to the body that it acts on, after the step. Local.
  void load_bodies();
  /// The row of the step just done on rank 0, nothing elsewhere or when none was wanted.
  /// Collective.
  std::optional<TrackRow> take_row();

  void begin_step(const std::vector<Particle>& particles, std::size_t owned) override;
  GrainGain gain(const Particle& particle, const GrainLoad& load) override;
  void give(std::int64_t id, Bytes& to) override;
  void take(std::int64_t id, ByteReader& from) override;

  void save_state(State& state, const StatePiece& piece = {}) const override;
  void begin_load() override;
  void load_rows(const StateTable& rows) override;
  void end_load() override;

  /// The fluid on a lattice; nullptr without one.
  const ResolvedFlow* lattice() const { return lattice_.get(); }

 private:
  Vec3 probe_force(const Particle& p) const;
  double reynolds(const Particle& p, const Vec3& velocity) const;
  GrainGain lattice_gain(const Particle& p, const GrainLoad& load, const Vec3& probe,
                         ForceParts& parts) const;
  void record(const Particle& p, const GrainGain& gain, const ForceParts& parts);

  World& world_;
  BoxWalls walls_;
  std::vector<ProbeCase> probes_;
  std::int64_t tracked_ = -1;
  FluidCase input_;
  std::optional<FluidForces> fluid_;                                 // mode submerged
  std::unique_ptr<ResolvedFlow> lattice_;                            // mode resolved
  std::unordered_map<std::int64_t, HistoryModes::Memory> memories_;  // by grain, of this rank's
  double time_ = 0.0;
  bool wants_row_ = false;
  double contacts_ = 0.0;  // of the tracked grain
  std::optional<TrackRow> row_;
};

}  // namespace grouser
