// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.hpp"
#include "base/errors.hpp"
#include "base/list_reach.hpp"
#include "engine/core/thread_clock.hpp"
#include "engine/dem/pair_pack.hpp"

namespace grouser {
namespace {

Decomposition first_cuts(const Communicator& ranks, const WorldSettings& settings) {
  const Vec3 low = settings.low;
  const Vec3 high{settings.high.x, settings.high.y,
                  settings.top > 0.0 ? settings.top : settings.high.z};
  const double reach = 2.0 * settings.largest_radius + settings.skin;
  const std::int64_t most = most_ranks(high.x - low.x, high.y - low.y, high.z - low.z, reach);
  if (ranks.size() > most)
    throw ConfigError({Problem{"", 0, 0, "ranks",
                               std::to_string(ranks.size()) +
                                   " ranks leave a rank less of the bed than a cube of the reach "
                                   "of a contact (" +
                                   std::to_string(reach) + " m)",
                               "use at most " + std::to_string(most)}});
  return Decomposition::even(low, high, ranks.size());
}

}  // namespace

World::World(const Communicator& ranks, const WorldSettings& settings)
    : ranks_(ranks),
      settings_(settings),
      threads_(settings.threads),
      boxes_(first_cuts(ranks, settings)),
      halo_(ranks),
      activity_(settings.activity, settings.gravity),
      pairs_(make_contact_law(settings.law, settings.grain, settings.grain, settings.grain_grain),
             make_rolling_law(settings.rolling, settings.grain_grain), threads_) {
  GROUSER_CHECK(settings.time_step > 0.0 && settings.largest_radius > 0.0 && settings.skin > 0.0);
  neighbours_ = boxes_.neighbours(ranks.rank(), 2.0 * settings.largest_radius + settings.skin);
  rounding_ = (norm(settings.low) + norm(settings.high)) * std::numeric_limits<float>::epsilon();
}

void World::add_particle(const Particle& particle) {
  GROUSER_CHECK(must_rebuild_ && particles_.size() == owned_);
  particles_.push_back(particle);
  origins_.push_back(particle.position);
  ++owned_;
}

std::size_t World::add_body(const std::string& name, Mesh mesh, const Solid& solid,
                            const Surface& surface, bool turns) {
  mesh.check(name);
  const double reach = settings_.largest_radius + settings_.skin;
  Body body;
  body.name = name;
  body.search = std::make_shared<const MeshSearch>(std::move(mesh), reach);
  body.solid = solid;
  body.surface = surface;
  body.turns = turns;
  bodies_.push_back(std::move(body));
  body_contacts_.emplace_back(make_contact_law(settings_.law, settings_.grain, solid, surface),
                              make_rolling_law(settings_.rolling, surface), threads_);
  loads_.emplace_back();
  return bodies_.size() - 1;
}

void World::set_grain_surface(const Surface& surface) {
  settings_.grain_grain = surface;
  pairs_.set_laws(make_contact_law(settings_.law, settings_.grain, settings_.grain, surface),
                  make_rolling_law(settings_.rolling, surface));
}

void World::reset_origins() {
  for (std::size_t i = 0; i < owned_; ++i) origins_[i] = particles_[i].position;
}

bool World::owns(const Vec3& position) const { return boxes_.owner_of(position) == ranks_.rank(); }

void World::reserve(std::size_t count) {
  // Some more, for ghosts.
  particles_.reserve(count + count / 16);
  origins_.reserve(count + count / 64);
}

World::StepResult World::step(double request) {
  bool are_new = must_rebuild_;
  if (must_rebuild_) {
    rebuild();
  } else {
    halo_.start(particles_);
  }
  const double begun = thread_seconds();
  // Bodies have moved since the last step at the velocity they have now.
  double body_speed = 0.0;
  for (const Body& body : bodies_) body_speed = std::max(body_speed, norm(body.motion.velocity));
  near_moved_ += body_speed * settings_.time_step;
  if (near_moved_ > settings_.skin) {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      body_contacts_[b].find_near(particles_, owned_, bodies_[b]);
    near_moved_ = 0.0;
    are_new = true;
  }

  if (forces_ != nullptr) forces_->begin_step(particles_, owned_);
  double waited = 0.0;
  const auto fetch_ghosts = [&] {
    waited -= thread_seconds();
    halo_.finish();
    waited += thread_seconds();
  };
  if (activity_.is_on()) {
    fetch_ghosts();  // who sleeps there is asked before anything else
    watch(are_new);
  }
  Communicator::StepTotals totals;
  double overlap = 0.0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    BodyLoad& load = loads_[b];
    load = BodyLoad{};
    overlap = std::max(overlap, body_contacts_[b].sweep(particles_, bodies_[b], settings_.time_step,
                                                        activity_, load));
    totals.sums.insert(totals.sums.end(), {load.force_x, load.force_y, load.force_z,
                                           load.force_moment_y, load.couple_y});
  }
  std::vector<Motion> motions(threads_.count());
  const auto move_on = [&](const PairContacts::Ready& ready) { move(ready, motions[ready.share]); };
  overlap = std::max(
      overlap, pairs_.sweep(particles_, settings_.time_step, move_on, fetch_ghosts, activity_));
  Motion motion;
  for (const Motion& one : motions) motion.add(one);
  busy_ += thread_seconds() - begun - waited;
  ++busy_steps_;
  totals.sums.emplace_back().add(busy_);
  totals.sums.push_back(motion.change.taken);
  totals.sums.emplace_back().add(std::isfinite(motion.sum) ? motion.sum : 0.0);
  totals.maxima = {std::sqrt(motion.fastest2),
                   std::sqrt(motion.slow2),
                   overlap,
                   motion.is_lost ? 1.0 : 0.0,
                   request,
                   busy_};
  ranks_.combine(totals);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    loads_[b] = {totals.sums[5 * b], totals.sums[5 * b + 1], totals.sums[5 * b + 2],
                 totals.sums[5 * b + 3], totals.sums[5 * b + 4]};

  if (activity_.is_on())
    activity_.end_step(motion.change.is_any, totals.sums[5 * bodies_.size() + 1].value());

  StepResult result;
  result.max_overlap = totals.maxima[2];
  result.request = totals.maxima[4];
  result.fastest = totals.maxima[0];
  if (totals.maxima[3] > 0.0) result.fault = Fault::kLostParticle;
  if (!std::isfinite(totals.maxima[0])) {
    result.fault = Fault::kNotANumber;
    return result;
  }
  const double way = totals.maxima[0] * settings_.time_step;
  moved_ += way;
  near_moved_ += way;
  pairs_.note_speeds(totals.maxima[1], totals.sums.back().value() / static_cast<double>(count_),
                     settings_.time_step);
  for (BodyContacts& contacts : body_contacts_) contacts.note_travel(way);
  if (moved_ > 0.5 * settings_.skin) moved_ = ranks_.max(displacement());
  must_rebuild_ = moved_ > 0.5 * settings_.skin ||
                  looks_uneven(totals.maxima[5], totals.sums[5 * bodies_.size()].value());
  return result;
}

// Lists of a body change only when all do, and those of bodies that move when one starts or stops.
void World::watch(bool are_new) {
  std::vector<std::uint32_t> struck;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].is_at_rest()) continue;
    const std::vector<std::uint32_t>& near = body_contacts_[b].near();
    struck.insert(struck.end(), near.begin(), near.end());
  }
  activity_.begin_step(particles_, owned_, are_new);
  pairs_.watch(particles_, struck, are_new || struck.size() != struck_, activity_);
  struck_ = struck.size();
}

void World::move(const PairContacts::Ready& ready, Motion& motion) {
  for (const BodyContacts& contacts : body_contacts_)
    contacts.each_push(ready.first, ready.last, [&](std::uint32_t grain, const double* push) {
      double* const load = ready.loads + kGrainLoad * (grain - ready.first);
      QuadPair sum;
      sum.add(load);
      sum.add(push);
      sum.store(load);
    });
  std::size_t first = ready.first;
  if (forces_ == nullptr && !activity_.is_on()) first += move_packs(ready, motion);
  const double dt = settings_.time_step;
  const Vec3 low = settings_.low;
  const Vec3 high = settings_.high;
  const double* from = ready.loads + kGrainLoad * (first - ready.first);
  for (std::size_t i = first; i < ready.last; ++i, from += kGrainLoad) {
    Particle& p = particles_[i];
    const GrainLoad load{{from[0], from[1], from[2]}, {from[4], from[5], from[6]}};
    if (activity_.is_on() && activity_.rests(i, p, load.force, load.moment, motion.change))
      continue;
    const GrainGain gain =
        forces_ == nullptr ? plain_gain(p, load, dt, settings_.gravity) : forces_->gain(p, load);
    p.velocity += gain.velocity;
    p.position += dt * p.velocity;
    p.spin += gain.spin;
    const Vec3& at = p.position;
    motion.is_lost |= !((at.x >= low.x) & (at.y >= low.y) & (at.z >= low.z) & (at.x <= high.x) &
                        (at.y <= high.y) & (at.z <= high.z));
    const double speed2 = norm2(p.velocity);
    motion.sum += std::abs(p.velocity.x) + std::abs(p.velocity.y) + std::abs(p.velocity.z);
    // The comparison is written so that a NaN takes over and stays.
    if (!(speed2 <= motion.fastest2) && !std::isnan(motion.fastest2)) motion.fastest2 = speed2;
    if (!std::isfinite(p.spin.x + p.spin.y + p.spin.z)) motion.fastest2 = NAN;
    if (speed2 > motion.slow2 && !pairs_.is_fast(i)) motion.slow2 = speed2;
  }
}

// Moves all grains that fill packs, to the same bits as one by one; returns how many.
std::size_t World::move_packs(const PairContacts::Ready& ready, Motion& motion) {
  const double dt = settings_.time_step;
  const Vec3T<Pack> low{settings_.low.x, settings_.low.y, settings_.low.z};
  const Vec3T<Pack> high{settings_.high.x, settings_.high.y, settings_.high.z};
  const std::size_t count = (ready.last - ready.first) / Pack::kLanes * Pack::kLanes;
  Pack fastest2(motion.fastest2);
  Pack slow2(motion.slow2);
  Pack sum;
  PackMask is_inside = Pack() >= Pack();
  PackMask is_finite = is_inside;
  for (std::size_t k = 0; k < count; k += Pack::kLanes) {
    double* const grains = &particles_[ready.first + k].position.x;
    const double* const loads = ready.loads + kGrainLoad * k;
    const auto rows = [](const double* from, std::size_t stride) {
      return [=](std::size_t lane) { return load_quad(from + lane * stride); };
    };
    Pack radius, mass, id;
    Vec3T<Pack> position = columns_of(rows(grains, kGrainStride), &radius);
    Vec3T<Pack> velocity = columns_of(rows(grains + kVelocityAt, kGrainStride), &mass);
    Vec3T<Pack> spin = columns_of(rows(grains + kSpinAt, kGrainStride), &id);
    const GrainGainT<Pack> gain =
        plain_gain(radius, mass, columns_of(rows(loads, kGrainLoad)),
                   columns_of(rows(loads + kGrainLoad / 2, kGrainLoad)), dt, settings_.gravity);
    velocity += gain.velocity;
    position += Pack(dt) * velocity;
    spin += gain.spin;
    Rows(position, radius).store(grains, kGrainStride);
    Rows(velocity, mass).store(grains + kVelocityAt, kGrainStride);
    Rows(spin, id).store(grains + kSpinAt, kGrainStride);
    is_inside = is_inside & (position.x >= low.x) & (position.y >= low.y) & (position.z >= low.z) &
                (high.x >= position.x) & (high.y >= position.y) & (high.z >= position.z);
    const Pack speed2 = norm2(velocity);
    const Pack turning = spin.x + spin.y + spin.z;
    // Neither holds for a NaN, nor for an infinite number's difference from itself.
    is_finite = is_finite & (speed2 - speed2 >= Pack()) & (turning - turning >= Pack());
    fastest2 = select(speed2 > fastest2, speed2, fastest2);
    sum += abs(velocity.x) + abs(velocity.y) + abs(velocity.z);
    if (!pairs_.has_fast(ready.first + k)) {
      slow2 = select(speed2 > slow2, speed2, slow2);
    } else {
      for (std::size_t lane = 0; lane < Pack::kLanes; ++lane)
        if (!pairs_.is_fast(ready.first + k + lane))
          motion.slow2 = std::max(motion.slow2, speed2[lane]);
    }
  }
  motion.is_lost |= any(!is_inside);
  for (std::size_t lane = 0; lane < Pack::kLanes; ++lane) {
    motion.fastest2 = std::max(motion.fastest2, fastest2[lane]);
    motion.slow2 = std::max(motion.slow2, slow2[lane]);
    motion.sum += sum[lane];
  }
  if (any(!is_finite)) motion.fastest2 = NAN;
  return count;
}

// A NaN takes over and stays.
void World::Motion::add(const Motion& other) {
  if (!(other.fastest2 <= fastest2) && !std::isnan(fastest2)) fastest2 = other.fastest2;
  slow2 = std::max(slow2, other.slow2);
  is_lost |= other.is_lost;
  sum += other.sum;
  change.add(other.change);
}

double World::displacement() const {
  double largest2 = 0.0;
  for (std::size_t i = 0; i < owned_; ++i)
    largest2 = std::max(largest2, norm2(particles_[i].position - built_at_[i].position()));
  return std::sqrt(largest2) + rounding_;
}

std::int64_t World::contacts() const {
  std::int64_t local = pairs_.count();
  for (const BodyContacts& contacts : body_contacts_)
    local += static_cast<std::int64_t>(contacts.count());
  return ranks_.sum(local);
}

std::int64_t World::sleepers() const {
  return ranks_.sum(std::count_if(particles_.begin(),
                                  particles_.begin() + static_cast<std::ptrdiff_t>(owned_),
                                  [](const Particle& p) { return is_asleep(p); }));
}

std::int64_t World::particle_count() const { return ranks_.sum(static_cast<std::int64_t>(owned_)); }

}  // namespace grouser
