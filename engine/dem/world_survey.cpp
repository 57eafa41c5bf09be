// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "engine/dem/world.hpp"

namespace grouser {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// From the one rank that knows them to all.
void spread(const Communicator& ranks, bool is_known, std::initializer_list<double*> values) {
  Communicator::StepTotals totals;
  for (const double* value : values) totals.maxima.push_back(is_known ? *value : -kInfinity);
  ranks.combine(totals);
  std::size_t k = 0;
  for (double* value : values) *value = totals.maxima[k++];
}

}  // namespace

double World::kinetic_energy() const {
  Communicator::StepTotals totals;
  totals.sums.resize(1);
  for (std::size_t i = 0; i < owned_; ++i) totals.sums[0].add(kinetic_energy_of(particles_[i]));
  ranks_.combine(totals);
  return totals.sums[0].value();
}

World::Survey World::survey() const {
  Communicator::StepTotals totals;
  totals.sums.resize(4);
  ExactSum& kinetic = totals.sums[0];
  ExactSum& potential = totals.sums[1];
  ExactSum& elastic = totals.sums[2];
  ExactSum& overlap = totals.sums[3];
  for (std::size_t i = 0; i < owned_; ++i) {
    const Particle& p = particles_[i];
    kinetic.add(kinetic_energy_of(p));
    potential.add(p.mass * settings_.gravity *
                  (p.position.z - 0.5 * settings_.time_step * p.velocity.z));
  }
  std::int64_t contacts = 0;
  pairs_.each_store(
      particles_, [&](std::uint32_t lower, std::uint32_t higher, const ContactStore& store) {
        elastic.add(store.energy);
        overlap.add(store.overlap / std::min(particles_[lower].radius, particles_[higher].radius));
        ++contacts;
      });
  for (const BodyContacts& on_body : body_contacts_)
    on_body.each_store(
        particles_, [&](std::uint32_t, const ContactStore& store) { elastic.add(store.energy); });
  ranks_.combine(totals);
  contacts = ranks_.sum(contacts);
  return {kinetic.value(), potential.value(), elastic.value(),
          contacts > 0 ? overlap.value() / static_cast<double>(contacts) : 0.0};
}

World::Culprit World::culprit(Fault fault) const {
  const auto is_it = [&](const Particle& p) {
    const Vec3& at = p.position;
    const bool is_number = std::isfinite(norm2(at) + norm2(p.velocity) + norm2(p.spin));
    const bool is_inside = at.x >= settings_.low.x && at.y >= settings_.low.y &&
                           at.z >= settings_.low.z && at.x <= settings_.high.x &&
                           at.y <= settings_.high.y && at.z <= settings_.high.z;
    return fault == Fault::kNotANumber ? !is_number : is_number && !is_inside;
  };
  constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  std::size_t place = owned_;
  for (std::size_t i = 0; i < owned_; ++i)
    if (is_it(particles_[i]) && (place == owned_ || particles_[i].id < particles_[place].id))
      place = i;
  const std::int64_t own = place < owned_ ? particles_[place].id : kNone;
  const std::int64_t lowest = -ranks_.max(-own);
  Culprit out;
  if (lowest == kNone) return out;
  out.id = lowest;
  if (own == lowest) {
    out.position = particles_[place].position;
    out.velocity = particles_[place].velocity;
    out.origin = origins_[place];
  }
  spread(ranks_, own == lowest,
         {&out.position.x, &out.position.y, &out.position.z, &out.velocity.x, &out.velocity.y,
          &out.velocity.z, &out.origin.x, &out.origin.y, &out.origin.z});
  return out;
}

World::Deepest World::deepest() const {
  Deepest own;
  const auto take = [&](double overlap, std::int64_t second, const Particle& first) {
    // Equal ones by id, so that all ranks name the same.
    if (overlap < own.overlap ||
        (overlap == own.overlap && own.first >= 0 && own.first <= first.id))
      return;
    own = {overlap, first.id, second, first.position};
  };
  pairs_.each_store(particles_,
                    [&](std::uint32_t lower, std::uint32_t higher, const ContactStore& store) {
                      const Particle& a = particles_[lower];
                      const Particle& b = particles_[higher];
                      take(store.overlap / std::min(a.radius, b.radius), b.id, a);
                    });
  for (std::size_t b = 0; b < body_contacts_.size(); ++b)
    body_contacts_[b].each_store(particles_, [&](std::uint32_t grain, const ContactStore& store) {
      const Particle& p = particles_[grain];
      take(store.overlap / p.radius, -1 - static_cast<int>(b), p);
    });
  const double overlap = ranks_.max(own.overlap);
  constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  const bool may_be = own.first >= 0 && own.overlap == overlap;
  const std::int64_t first = -ranks_.max(-(may_be ? own.first : kNone));
  if (first == kNone) return {};
  const bool is_mine = may_be && own.first == first;
  double second = static_cast<double>(own.second);
  spread(ranks_, is_mine, {&second, &own.position.x, &own.position.y, &own.position.z});
  return {overlap, first, static_cast<std::int64_t>(second), own.position};
}

}  // namespace grouser
