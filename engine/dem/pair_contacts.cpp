// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/pair_contacts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "base/check.hpp"
#include "engine/core/pack.hpp"
#include "engine/dem/history_view.hpp"

namespace grouser {
namespace {

constexpr std::size_t kLanes = Pack::kLanes;
constexpr std::uint32_t kNoSlot = std::numeric_limits<std::uint32_t>::max();

// Grains whose contacts are evaluated before their forces are added up; the results in between
// stay in the nearest caches.
constexpr std::size_t kChunk = 256;

// Numbers of a slot that do not change: both radii, effective radius, effective mass.
constexpr std::size_t kShape = 4;

// Numbers of a slot's result, each vector filled up to four: force on the lower id, moment on the
// lower id, moment on the higher id.
constexpr std::size_t kResult = 12;

// Steps that the slots should last at the present speed, within these shares of the skin.
constexpr double kSlotSteps = 24.0;
constexpr double kLeastGap = 0.04;
constexpr double kLargestGap = 0.5;

}  // namespace

PairContacts::PairContacts(ContactLaw law, RollingLaw rolling)
    : law_(law), rolling_(rolling), history_width_(history_width(law, rolling)) {}

void PairContacts::set_laws(ContactLaw law, RollingLaw rolling) {
  GROUSER_CHECK(law.index() == law_.index() && rolling.index() == rolling_.index());
  law_ = law;
  rolling_ = rolling;
}

void PairContacts::build(const std::vector<Particle>& particles, std::size_t owned, double skin,
                         const ContactRecords& records) {
  GROUSER_CHECK(records.particles() == owned && records.value_width() == history_width_);
  skin_ = skin;
  list_.build(particles, owned, skin);
  // A slot and its side share 32 bits.
  GROUSER_CHECK(list_.pairs() < std::numeric_limits<std::int32_t>::max() / 2);
  slot_of_.assign(list_.pairs(), kNoSlot);
  refresh(particles, &records);
}

void PairContacts::note_travel(double distance) {
  travel_ += distance;
  last_travel_ = distance;
}

// Finds the pairs that may touch soon. Histories come from `records`, or from the slots before.
void PairContacts::refresh(const std::vector<Particle>& particles, const ContactRecords* records) {
  gap_ = std::clamp(2.0 * kSlotSteps * last_travel_, kLeastGap * skin_, kLargestGap * skin_);
  travel_ = 0.0;
  Slots next;
  next.lower.reserve(slots_.lower.size());
  next.higher.reserve(slots_.lower.size());
  next.shape.reserve(slots_.shape.size());
  next.history.reserve(slots_.history.size());
  next.touching.reserve(slots_.touching.size());
  chunk_end_.clear();
  for (std::size_t i = 0; i < list_.owned(); ++i) {
    for (std::uint32_t k = list_.begin(i); k < list_.end(i); ++k) {
      if (is_within(particles[i], particles[list_.partner(k)], gap_)) {
        const auto slot = static_cast<std::uint32_t>(next.lower.size());
        add_slot(particles, i, k, records, next);
        slot_of_[k] = slot;
      } else {
        slot_of_[k] = kNoSlot;
      }
    }
    if ((i + 1) % kChunk == 0 || i + 1 == list_.owned()) {
      add_padding(next);
      chunk_end_.push_back(static_cast<std::uint32_t>(next.lower.size()));
    }
  }
  slots_ = std::move(next);
  order_sides();
}

void PairContacts::add_slot(const std::vector<Particle>& particles, std::size_t i,
                            std::uint32_t pair, const ContactRecords* records, Slots& next) const {
  const std::size_t lane = next.lower.size() % kLanes;
  if (lane == 0) {
    next.shape.resize(next.shape.size() + kShape * kLanes, 0.0);
    next.history.resize(next.history.size() + history_width_ * kLanes, 0.0);
    next.touching.push_back(0);
  }
  const std::uint32_t j = list_.partner(pair);
  const bool is_lower = particles[i].id < particles[j].id;
  const Particle& a = is_lower ? particles[i] : particles[j];
  const Particle& b = is_lower ? particles[j] : particles[i];
  next.lower.push_back(is_lower ? static_cast<std::uint32_t>(i) : j);
  next.higher.push_back(is_lower ? j : static_cast<std::uint32_t>(i));

  double* const shape = next.shape.data() + next.shape.size() - kShape * kLanes + lane;
  shape[0] = a.radius;
  shape[kLanes] = b.radius;
  shape[2 * kLanes] = a.radius * b.radius / (a.radius + b.radius);
  shape[3 * kLanes] = a.mass * b.mass / (a.mass + b.mass);

  std::array<double, 16> values{};
  bool touches = false;
  if (records == nullptr) {
    if (slot_of_[pair] == kNoSlot || !is_touching(slot_of_[pair])) return;
    touches = true;
    history_of(slots_, slot_of_[pair], values.data());
  } else {
    for (std::size_t r = records->begin(i); r < records->end(i) && !touches; ++r) {
      if (records->names(r)[0] != particles[j].id) continue;
      std::copy_n(records->values(r), history_width_, values.begin());
      touches = true;
    }
    if (!touches) return;
  }
  double* const history =
      next.history.data() + next.history.size() - history_width_ * kLanes + lane;
  for (std::size_t c = 0; c < history_width_; ++c) history[c * kLanes] = values[c];
  next.touching.back() |= static_cast<std::uint8_t>(1u << lane);
}

// A grain against itself, without a radius: never touches.
void PairContacts::add_padding(Slots& next) const {
  while (next.lower.size() % kLanes != 0) {
    next.lower.push_back(next.lower.back());
    next.higher.push_back(next.lower.back());
  }
}

// Lists each grain's slots by partner id, and finds how far back an adding grain looks.
void PairContacts::order_sides() {
  side_start_.assign(1, 0);
  sides_.clear();
  std::uint32_t window = kLanes;
  for (std::size_t i = 0; i < list_.owned(); ++i) {
    const std::uint32_t end = chunk_end_[i / kChunk];
    for (std::uint32_t at = list_.side_begin(i); at < list_.side_end(i); ++at) {
      const std::uint32_t slot = slot_of_[list_.by_partner()[at]];
      if (slot == kNoSlot) continue;
      // With a partner of lower id, this grain is the higher one.
      sides_.push_back(2 * slot + (at < list_.side_split(i) ? 1 : 0));
      window = std::max(window, end - slot);
    }
    side_start_.push_back(static_cast<std::uint32_t>(sides_.size()));
  }
  const std::uint32_t capacity = std::bit_ceil(window);
  result_mask_ = capacity - 1;
  if (results_.size() < capacity * kResult) results_.resize(capacity * kResult);
}

bool PairContacts::is_touching(std::uint32_t slot) const {
  return (slots_.touching[slot / kLanes] >> (slot % kLanes) & 1u) != 0;
}

void PairContacts::history_of(const Slots& slots, std::uint32_t slot, double* values) const {
  const double* const pack =
      slots.history.data() + slot / kLanes * history_width_ * kLanes + slot % kLanes;
  for (std::size_t c = 0; c < history_width_; ++c) values[c] = pack[c * kLanes];
}

template <class Law, class Rolling>
double PairContacts::sweep(const Law& law, const Rolling& rolling,
                           const std::vector<Particle>& particles, double time_step,
                           std::vector<Vec3>& force, std::vector<Vec3>& moment) {
  using View = HistoryView<Law, Rolling, Pack>;
  const Particle* const grains = particles.data();
  const auto vectors = [&](const std::uint32_t* at, auto member) {
    return columns_of([&](std::size_t k) { return load_quad(&(grains[at[k]].*member).x); });
  };
  // Differences are formed record by record: half the work of turning both.
  const auto difference = [&](const std::uint32_t* a, const std::uint32_t* b, auto member) {
    return columns_of([&](std::size_t k) {
      return load_quad(&(grains[a[k]].*member).x) - load_quad(&(grains[b[k]].*member).x);
    });
  };

  Pack largest;
  std::uint32_t slot = 0;
  for (std::size_t chunk = 0; chunk < chunk_end_.size(); ++chunk) {
    for (; slot < chunk_end_[chunk]; slot += kLanes) {
      const std::uint32_t* const lower = &slots_.lower[slot];
      const std::uint32_t* const higher = &slots_.higher[slot];
      const double* const shape = &slots_.shape[slot * kShape];
      double* const stored = slots_.history.data() + slot * View::kWidth;
      double* const result = &results_[(slot & result_mask_) * kResult];
      std::uint8_t& touching = slots_.touching[slot / kLanes];

      const Vec3T<Pack> apart = difference(lower, higher, &Particle::position);
      const Pack radius_a = Pack::load(shape);
      const Pack radius_b = Pack::load(shape + kLanes);
      const Pack reach = radius_a + radius_b;
      const Pack distance2 = norm2(apart);
      // Written so that a NaN counts as a touch and spreads to where it is noticed.
      const PackMask touches = !(distance2 >= reach * reach);
      const unsigned touches_bits = touches.to_unsigned();
      if (touches_bits == 0) {
        std::fill_n(result, kResult * kLanes, 0.0);
        if (touching != 0) std::fill_n(stored, View::kWidth * kLanes, 0.0);
        touching = 0;
        continue;
      }
      touching = static_cast<std::uint8_t>(touches_bits);

      const Pack distance = sqrt(distance2);
      ContactPointT<Pack> at;
      at.overlap = reach - distance;
      at.radius = Pack::load(shape + 2 * kLanes);
      at.mass = Pack::load(shape + 3 * kLanes);
      at.normal = (Pack(1.0) / distance) * apart;
      const Vec3T<Pack> velocity = difference(lower, higher, &Particle::velocity);
      at.normal_velocity = dot(velocity, at.normal);
      const Pack half = Pack(0.5) * at.overlap;
      const Pack arm_a = radius_a - half;
      const Pack arm_b = radius_b - half;
      const Vec3T<Pack> spin_a = vectors(lower, &Particle::spin);
      const Vec3T<Pack> spin_b = vectors(higher, &Particle::spin);
      at.slip_velocity = velocity - at.normal_velocity * at.normal -
                         cross(arm_a * spin_a + arm_b * spin_b, at.normal);
      const Vec3T<Pack> spin = spin_a - spin_b;
      at.rolling_rate = spin - dot(spin, at.normal) * at.normal;

      typename View::LawHistory contact_history;
      typename View::RollingHistory rolling_history;
      View::load(stored, contact_history, rolling_history);
      const ContactForceT<Pack> contact = law.evaluate(at, contact_history, time_step);
      const Vec3T<Pack> turning = rolling.evaluate(at, contact, rolling_history, time_step);
      View::store(stored, contact_history, rolling_history);
      Vec3T<Pack> on_lower = contact.normal * at.normal + contact.tangential;
      const Vec3T<Pack> twist = cross(contact.tangential, at.normal);
      Vec3T<Pack> turn_a = arm_a * twist + turning;
      Vec3T<Pack> turn_b = arm_b * twist - turning;
      if (touches_bits != (1u << kLanes) - 1) {
        const Vec3T<Pack> none;
        on_lower = select(touches, on_lower, none);
        turn_a = select(touches, turn_a, none);
        turn_b = select(touches, turn_b, none);
        for (std::size_t c = 0; c < View::kWidth; ++c)
          select(touches, Pack::load(stored + c * kLanes), Pack()).store(stored + c * kLanes);
      }
      // A new largest share is rare: the division waits for it.
      const Pack smaller = select(radius_a < radius_b, radius_a, radius_b);
      const PackMask is_larger = touches & (at.overlap > largest * smaller);
      if (any(is_larger)) largest = select(is_larger, at.overlap / smaller, largest);
      store_rows(on_lower, result, kResult);
      store_rows(turn_a, result + 4, kResult);
      store_rows(turn_b, result + 8, kResult);
    }
    add_up(chunk, force, moment);
  }
  double result = 0.0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) result = std::max(result, largest[lane]);
  return result;
}

// Forces of a chunk's grains: all their slots have been evaluated by now.
void PairContacts::add_up(std::size_t chunk, std::vector<Vec3>& force,
                          std::vector<Vec3>& moment) const {
  // Turns the force on the lower id into that on the higher: only the sign bits differ.
  alignas(32) static constexpr double kSign[8] = {0.0, 0.0, 0.0, 0.0, -0.0, -0.0, -0.0, -0.0};
  const std::size_t end = std::min((chunk + 1) * kChunk, list_.owned());
  for (std::size_t i = chunk * kChunk; i < end; ++i) {
    Quad sum{};
    Quad turn{};
    for (std::uint32_t at = side_start_[i]; at < side_start_[i + 1]; ++at) {
      const std::uint32_t side = sides_[at];
      const std::uint32_t is_higher = side & 1u;
      const double* const result = &results_[(side >> 1 & result_mask_) * kResult];
      sum += flip_signs(load_quad(result), load_quad(kSign + 4 * is_higher));
      turn += load_quad(result + 4 + 4 * is_higher);
    }
    force[i] += Vec3{sum[0], sum[1], sum[2]};
    moment[i] += Vec3{turn[0], turn[1], turn[2]};
  }
}

double PairContacts::add_forces(const std::vector<Particle>& particles, double time_step,
                                std::vector<Vec3>& force, std::vector<Vec3>& moment) {
  // Two grains may have come closer by twice the way of one; a hair more for rounding.
  if (2.0 * travel_ * (1.0 + 1e-9) >= gap_) refresh(particles, nullptr);
  return std::visit(
      [&](const auto& law, const auto& rolling) {
        return sweep(law, rolling, particles, time_step, force, moment);
      },
      law_, rolling_);
}

ContactRecords PairContacts::records(const std::vector<Particle>& particles) const {
  ContactRecords out = empty_records();
  std::array<double, 16> values{};
  for (std::size_t i = 0; i < list_.owned(); ++i) {
    for (std::uint32_t at = side_start_[i]; at < side_start_[i + 1]; ++at) {
      const std::uint32_t slot = sides_[at] >> 1;
      if (!is_touching(slot)) continue;
      const std::uint32_t lower = slots_.lower[slot];
      const std::int64_t other = particles[lower == i ? slots_.higher[slot] : lower].id;
      history_of(slots_, slot, values.data());
      out.add(&other, values.data());
    }
    out.close_particle();
  }
  return out;
}

std::vector<StateField> PairContacts::history_fields() const {
  std::vector<StateField> fields = std::visit(
      [](const auto& law) { return std::decay_t<decltype(law)>::history_fields(); }, law_);
  const std::vector<StateField> more = std::visit(
      [](const auto& law) { return std::decay_t<decltype(law)>::history_fields(); }, rolling_);
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

std::int64_t PairContacts::count() const {
  std::int64_t total = 0;
  for (std::uint32_t slot = 0; slot < slots_.lower.size(); ++slot)
    if (is_touching(slot) && slots_.lower[slot] < list_.owned()) ++total;
  return total;
}

}  // namespace grouser
