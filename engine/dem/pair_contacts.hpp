// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/aligned.hpp"
#include "engine/core/particle.hpp"
#include "engine/core/state_io.hpp"
#include "engine/dem/contact_records.hpp"
#include "engine/dem/laws/table.hpp"
#include "engine/dem/pair_list.hpp"

namespace grouser {

/// Contacts between grains: neighbour list, contact histories, forces.
///
/// Each pair is evaluated once per rank that owns one of its grains, oriented from the higher to
/// the lower id, and each grain adds its pair forces in the order of partner ids. So forces do not
/// depend, to the last bit, on the order of particles in memory, on ranks, on the skin or on when
/// a list was made.
///
/// Two lists: the PairList, made anew when grains have moved half a skin, and within it the slots,
/// those pairs that are so close that they may touch within the next steps. Only slots are looked
/// at in a step, four at a time, and only slots have histories.
class PairContacts {
 public:
  PairContacts(ContactLaw law, RollingLaw rolling);

  void set_laws(ContactLaw law, RollingLaw rolling);  ///< of the same kinds; histories stay

  /// Makes both lists. @param skin as in PairList [m]
  /// @param particles owned grains first, then ghosts
  /// @param records   histories by owned grain, to be taken over
  void build(const std::vector<Particle>& particles, std::size_t owned, double skin,
             const ContactRecords& records);

  /// Adds the forces [N] and moments [N m] of all contacts to those of the owned grains.
  /// @return largest overlap over the smaller radius of the pair [1]
  double add_forces(const std::vector<Particle>& particles, double time_step,
                    std::vector<Vec3>& force, std::vector<Vec3>& moment);

  /// Tells that no grain, ghosts included, has moved by more than `distance` [m] in a step.
  void note_travel(double distance);

  /// Histories of the touching contacts of the owned grains, listed under each of the two that is
  /// owned; name = partner's id.
  ContactRecords records(const std::vector<Particle>& particles) const;
  ContactRecords empty_records() const { return ContactRecords(1, history_width_); }
  std::vector<StateField> history_fields() const;

  /// Contacts that touch, each counted on the rank that owns its lower id.
  std::int64_t count() const;

 private:
  // Pairs that a step looks at, in the order of the list; padded with pairs of nothing so that
  // the slots of a chunk of grains fill whole packs.
  struct Slots {
    std::vector<std::uint32_t> lower;    // grain with the lower id
    std::vector<std::uint32_t> higher;   // grain with the higher id
    LineVector<double> shape;            // packs of kShape numbers: what does not change
    LineVector<double> history;          // packs of history_width_ numbers
    std::vector<std::uint8_t> touching;  // of each pack, bit k = lane k
  };

  void refresh(const std::vector<Particle>& particles, const ContactRecords* records);
  void add_slot(const std::vector<Particle>& particles, std::size_t i, std::uint32_t pair,
                const ContactRecords* records, Slots& next) const;
  void add_padding(Slots& next) const;
  void order_sides();
  bool is_touching(std::uint32_t slot) const;
  void history_of(const Slots& slots, std::uint32_t slot, double* values) const;

  template <class Law, class Rolling>
  double sweep(const Law& law, const Rolling& rolling, const std::vector<Particle>& particles,
               double time_step, std::vector<Vec3>& force, std::vector<Vec3>& moment);
  void add_up(std::size_t chunk, std::vector<Vec3>& force, std::vector<Vec3>& moment) const;

  ContactLaw law_;
  RollingLaw rolling_;
  std::size_t history_width_ = 0;
  PairList list_;
  double skin_ = 0.0;
  Slots slots_;
  std::vector<std::uint32_t> slot_of_;     // of each listed pair, kNoSlot when it has none
  std::vector<std::uint32_t> chunk_end_;   // slots of each chunk of grains end here
  std::vector<std::uint32_t> side_start_;  // of each owned grain's slots by partner id
  std::vector<std::uint32_t> sides_;       // twice the slot, + 1 where the grain has the higher id
  double gap_ = 0.0;                       // pairs closer than this have slots [m]
  double travel_ = 0.0;                    // bound of a grain's way since the slots were made [m]
  double last_travel_ = 0.0;               // in the last step [m]
  // What each slot does in this step, kept only until both its grains have added it up.
  LineVector<double> results_;
  std::uint32_t result_mask_ = 0;
};

}  // namespace grouser
