// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/particle.hpp"
#include "engine/core/state_io.hpp"
#include "engine/dem/contact_records.hpp"
#include "engine/dem/laws/table.hpp"

namespace grouser {

/// Contacts between grains: neighbour list, contact histories, forces.
///
/// Each pair is evaluated once per rank that owns one of its grains, oriented from the higher to
/// the lower id, and each grain adds its pair forces in the order of partner ids. So forces do not
/// depend, to the last bit, on the order of particles in memory, on ranks, on the skin or on when
/// the list was made.
class PairContacts {
 public:
  PairContacts(ContactLaw law, RollingLaw rolling);

  void set_laws(ContactLaw law, RollingLaw rolling);  ///< of the same kinds; histories stay

  /// Makes the list of pairs closer than the sum of radii + `skin` [m] that have an owned grain.
  /// @param particles owned grains first, then ghosts
  /// @param records   histories by owned grain, to be taken over
  void build(const std::vector<Particle>& particles, std::size_t owned, double skin,
             const ContactRecords& records);

  /// Adds the forces [N] and moments [N m] of all contacts to those of the owned grains.
  /// @return largest overlap over the smaller radius of the pair [1]
  double add_forces(const std::vector<Particle>& particles, double time_step,
                    std::vector<Vec3>& force, std::vector<Vec3>& moment);

  /// Histories of the touching contacts of the owned grains, listed under each of the two that is
  /// owned; name = partner's id.
  ContactRecords records(const std::vector<Particle>& particles) const;
  ContactRecords empty_records() const { return ContactRecords(1, history_width_); }
  std::vector<StateField> history_fields() const;

  /// Contacts that touch, each counted on the rank that owns its lower id.
  std::int64_t count(const std::vector<Particle>& particles) const;

 private:
  // What one touching contact does in this step.
  struct PairForce {
    Vec3 force;           // on the lower id
    Vec3 twist;           // -(normal x force): times its arm, the moment on either grain
    Vec3 moment;          // rolling moment on the lower id
    double half_overlap;  // shortens the arms
  };

  void list_pairs(const std::vector<Particle>& particles, double skin);
  void take_histories(const std::vector<Particle>& particles, const ContactRecords& records);
  void order_by_partner(const std::vector<Particle>& particles);
  template <class Law, class Rolling>
  double sweep(const Law& law, const Rolling& rolling, const std::vector<Particle>& particles,
               double time_step);

  ContactLaw law_;
  RollingLaw rolling_;
  std::size_t history_width_ = 0;
  std::size_t owned_ = 0;
  std::vector<std::uint32_t> start_;     // of each owned grain's pairs
  std::vector<std::uint32_t> partner_;   // second grain of each pair
  std::vector<double> history_;          // pairs x history_width_
  std::vector<std::int32_t> output_of_;  // of each pair, -1 when it does not touch
  std::vector<PairForce> outputs_;
  std::vector<std::uint32_t> by_partner_start_;  // pairs of each owned grain by partner id
  std::vector<std::uint32_t> by_partner_;
  std::vector<std::uint32_t> higher_from_;  // where partners with higher ids begin
};

}  // namespace grouser
