// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "base/check.hpp"
#include "engine/core/cell_grid.hpp"
#include "engine/dem/world.hpp"

namespace grouser {
namespace {

constexpr std::uint32_t kGone = PairContacts::kGone;

// Up to so many grains a rank's pair results fit a cache. More grains have little to wait for.
constexpr std::size_t kFewGrains = 32768;

}  // namespace

void World::rebuild() {
  count_ = particle_count();
  cut_if_uneven();
  std::vector<bool> leaves(owned_, false);
  std::vector<Bytes> messages;
  if (ranks_.size() > 1) messages = exchange_leaving(leaves);
  const std::vector<Arrival> arrivals = arrivals_in(messages);
  std::vector<std::uint32_t> number = numbers_by_cell(leaves, arrivals);
  pairs_.renumber(particles_, number);  // while partners that are ghosts can still be named
  for (BodyContacts& contacts : body_contacts_) contacts.renumber(number);
  particles_.resize(owned_);
  for (std::size_t a = 0; a < arrivals.size(); ++a) {
    keep_histories(number[owned_ + a], arrivals[a].particle.id,
                   ByteReader(messages[arrivals[a].message], arrivals[a].histories));
    particles_.push_back(arrivals[a].particle);
    origins_.push_back(arrivals[a].origin);
  }
  messages = {};
  put_in_order(std::move(number));

  built_at_.clear();
  built_at_.reserve(owned_);
  for (std::size_t i = 0; i < owned_; ++i) {
    const Vec3& at = particles_[i].position;
    built_at_.push_back(
        {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)});
  }
  halo_.build(ranks_, boxes_, neighbours_, settings_.largest_radius, settings_.skin, particles_);
  pairs_.build(particles_, owned_, settings_.skin);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    body_contacts_[b].build(particles_, owned_, bodies_[b], settings_.skin);
  must_rebuild_ = false;
  may_be_far_ = false;
  moved_ = 0.0;
  near_moved_ = 0.0;
}

// Sends grains that have left this rank's box to their owners, with copies of their histories.
std::vector<Bytes> World::exchange_leaving(std::vector<bool>& leaves) const {
  for (std::size_t i = 0; i < owned_; ++i)
    leaves[i] = boxes_.owner_of(particles_[i].position) != ranks_.rank();
  PairHistories pairs(pairs_.history_width());
  pairs_.histories_of(particles_, leaves, pairs);
  pairs.sort();

  std::map<int, Bytes> out;
  for (std::uint32_t i = 0; i < owned_; ++i) {
    if (!leaves[i]) continue;
    Bytes& to = out[boxes_.owner_of(particles_[i].position)];
    append_bytes(to, &particles_[i], 1);
    append_bytes(to, &origins_[i], 1);
    std::int64_t count = 0;
    pairs.each_of(i, [&](std::int64_t, const double*) { ++count; });
    append_bytes(to, &count, 1);
    pairs.each_of(i, [&](std::int64_t partner, const double* values) {
      append_bytes(to, &partner, 1);
      append_bytes(to, values, pairs.width());
    });
    for (const BodyContacts& contacts : body_contacts_) {
      count = 0;
      contacts.each_touch(i, i + 1, [&](std::uint32_t, int, const double*) { ++count; });
      append_bytes(to, &count, 1);
      contacts.each_touch(i, i + 1, [&](std::uint32_t, std::int64_t facet, const double* history) {
        append_bytes(to, &facet, 1);
        append_bytes(to, history, contacts.history_width());
      });
    }
    Bytes memory;
    if (forces_ != nullptr) forces_->give(particles_[i].id, memory);
    count = static_cast<std::int64_t>(memory.size());
    append_bytes(to, &count, 1);
    append_bytes(to, memory.data(), memory.size());
  }

  return deliver(std::move(out));
}

// Grains that were with their owners at the last rebuild have come no farther than a neighbour.
std::vector<Bytes> World::deliver(std::map<int, Bytes> out) const {
  const double reach = 2.0 * settings_.largest_radius + settings_.skin;
  const bool goes_far = may_be_far_ || !(moved_ < reach);
  std::vector<Bytes> parcels;
  const auto add = [&](int rank) {
    const auto parcel = out.find(rank);
    parcels.push_back(parcel == out.end() ? Bytes{} : std::move(parcel->second));
    if (parcel != out.end()) out.erase(parcel);
  };
  if (goes_far) {
    for (int rank = 0; rank < ranks_.size(); ++rank) add(rank);
    return ranks_.exchange_all(parcels);
  }
  for (const int rank : neighbours_) add(rank);
  GROUSER_CHECK(out.empty());
  return ranks_.exchange_with(neighbours_, parcels);
}

std::vector<World::Arrival> World::arrivals_in(const std::vector<Bytes>& messages) const {
  std::vector<Arrival> arrivals;
  for (std::size_t m = 0; m < messages.size(); ++m) {
    ByteReader reader(messages[m]);
    while (!reader.empty()) {
      Arrival& arrival = arrivals.emplace_back();
      reader.take(&arrival.particle, 1);
      reader.take(&arrival.origin, 1);
      arrival.message = m;
      arrival.histories = reader.position();
      const auto pass = [&](std::size_t width) {
        std::size_t count = 0;
        reader.take(&count, 1);
        reader.skip(count * (sizeof(std::int64_t) + width * sizeof(double)));
      };
      pass(pairs_.history_width());
      for (const BodyContacts& contacts : body_contacts_) pass(contacts.history_width());
      std::size_t memory = 0;
      reader.take(&memory, 1);
      reader.skip(memory);
    }
  }
  return arrivals;
}

// Keeps the histories of an arrival, as exchange_leaving has written them.
void World::keep_histories(std::uint32_t grain, std::int64_t id, ByteReader reader) {
  std::int64_t name = 0;
  std::vector<double> values;
  const auto each = [&](std::size_t width, const auto& keep) {
    std::int64_t count = 0;
    values.resize(width);
    for (reader.take(&count, 1); count > 0; --count) {
      reader.take(&name, 1);
      reader.take(values.data(), width);
      keep();
    }
  };
  each(pairs_.history_width(), [&] { pairs_.keep(grain, name, values.data()); });
  for (BodyContacts& contacts : body_contacts_)
    each(contacts.history_width(),
         [&] { contacts.keep(grain, static_cast<int>(name), values.data()); });
  std::int64_t memory = 0;
  reader.take(&memory, 1);
  if (memory > 0) forces_->take(id, reader);
}

// New numbers of the grains owned till now, kGone for those that leave, then of the arrivals: cell
// by cell, so that neighbours in space are neighbours in memory, and by id within a cell. Where
// there are few, those that may have ghosts come last: the others need not wait for ghosts.
std::vector<std::uint32_t> World::numbers_by_cell(const std::vector<bool>& leaves,
                                                  const std::vector<Arrival>& arrivals) const {
  const std::size_t all = owned_ + arrivals.size();
  const auto grain = [&](std::size_t i) -> const Particle& {
    return i < owned_ ? particles_[i] : arrivals[i - owned_].particle;
  };
  const auto stays = [&](std::size_t i) { return i >= owned_ || !leaves[i]; };
  Vec3 low = settings_.high;
  Vec3 high = settings_.low;
  for (std::size_t i = 0; i < all; ++i) {
    const Vec3& at = grain(i).position;
    low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
  }
  const CellGrid grid(low, high, 2.0 * settings_.largest_radius + settings_.skin, 2 * all + 64);
  const bool parts = ranks_.size() > 1 && all <= kFewGrains;
  const Box& box = boxes_.box(ranks_.rank());
  const auto cell_of = [&](std::size_t i) {
    const Particle& p = grain(i);
    const bool is_last =
        parts && box.depth(p.position) < Halo::reach(p, settings_.largest_radius, settings_.skin);
    return grid.index(grid.cell_of(p.position)) + (is_last ? grid.cells() : 0);
  };
  // Counted two places up, so that filling a cell moves its mark to where the next one begins.
  std::vector<std::uint32_t> first((parts ? 2 : 1) * grid.cells() + 2, 0);
  std::size_t staying = 0;
  for (std::size_t i = 0; i < all; ++i) {
    if (!stays(i)) continue;
    ++first[cell_of(i) + 2];
    ++staying;
  }
  for (std::size_t c = 2; c < first.size(); ++c) first[c] += first[c - 1];
  std::vector<std::uint32_t> members(staying);
  for (std::size_t i = 0; i < all; ++i)
    if (stays(i)) members[first[cell_of(i) + 1]++] = static_cast<std::uint32_t>(i);
  for (std::size_t c = 0; c + 1 < first.size(); ++c)
    std::sort(members.begin() + first[c], members.begin() + first[c + 1],
              [&](std::uint32_t a, std::uint32_t b) { return grain(a).id < grain(b).id; });
  std::vector<std::uint32_t> number(all, kGone);
  for (std::uint32_t k = 0; k < staying; ++k) number[members[k]] = k;
  return number;
}

// Puts grains where their numbers say and drops those that have gone.
void World::put_in_order(std::vector<std::uint32_t> number) {
  const auto gone = std::count(number.begin(), number.end(), kGone);
  auto behind = static_cast<std::uint32_t>(number.size() - static_cast<std::size_t>(gone));
  owned_ = behind;
  for (std::uint32_t& to : number)
    if (to == kGone) to = behind++;
  for (std::uint32_t i = 0; i < number.size(); ++i)
    while (number[i] != i) {
      const std::uint32_t to = number[i];
      std::swap(particles_[i], particles_[to]);
      std::swap(origins_[i], origins_[to]);
      std::swap(number[i], number[to]);
    }
  particles_.resize(owned_);
  origins_.resize(owned_);
}

}  // namespace grouser
