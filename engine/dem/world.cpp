// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/world.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.hpp"
#include "engine/dem/cell_grid.hpp"

namespace grouser {
namespace {

constexpr double kSphereInertia = 0.4;  // of a homogeneous sphere, over m r^2

}  // namespace

World::World(const Communicator& ranks, const WorldSettings& settings)
    : ranks_(ranks),
      settings_(settings),
      columns_(settings.low, settings.high, ranks.size(), ranks.rank(),
               2.0 * settings.largest_radius + settings.skin),
      pairs_(make_contact_law(settings.law, settings.grain, settings.grain, settings.grain_grain),
             make_rolling_law(settings.rolling, settings.grain_grain)) {
  GROUSER_CHECK(settings.time_step > 0.0 && settings.largest_radius > 0.0 && settings.skin > 0.0);
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
                              make_rolling_law(settings_.rolling, surface));
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

World::StepResult World::step(double request) {
  bool lost = false;
  if (must_rebuild_) {
    lost = has_lost_particle();
    rebuild();
  } else {
    halo_.update(ranks_, particles_);
  }
  // Bodies have moved since the last step at the velocity they have now.
  double body_speed = 0.0;
  for (const Body& body : bodies_) body_speed = std::max(body_speed, norm(body.motion.velocity));
  near_moved_ += body_speed * settings_.time_step;
  if (near_moved_ > settings_.skin) {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      body_contacts_[b].find_near(particles_, owned_, bodies_[b]);
    near_moved_ = 0.0;
  }

  force_.assign(owned_, Vec3{});
  moment_.assign(owned_, Vec3{});
  double overlap = pairs_.add_forces(particles_, settings_.time_step, force_, moment_);
  Communicator::StepTotals totals;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    loads_[b] = BodyLoad{};
    overlap =
        std::max(overlap, body_contacts_[b].add_forces(particles_, bodies_[b], settings_.time_step,
                                                       force_, moment_, loads_[b]));
    const BodyLoad& load = loads_[b];
    totals.sums.insert(totals.sums.end(), {load.force_x, load.force_y, load.force_z,
                                           load.force_moment_y, load.couple_y});
  }
  const double speed = move_owned();
  totals.maxima = {speed, overlap, lost ? 1.0 : 0.0, request};
  ranks_.combine(totals);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    loads_[b] = {totals.sums[5 * b], totals.sums[5 * b + 1], totals.sums[5 * b + 2],
                 totals.sums[5 * b + 3], totals.sums[5 * b + 4]};

  StepResult result;
  result.max_overlap = totals.maxima[1];
  result.request = totals.maxima[3];
  if (totals.maxima[2] > 0.0) result.fault = Fault::kLostParticle;
  if (!std::isfinite(totals.maxima[0])) {
    result.fault = Fault::kNotANumber;
    return result;
  }
  moved_ += totals.maxima[0] * settings_.time_step;
  near_moved_ += totals.maxima[0] * settings_.time_step;
  pairs_.note_travel(totals.maxima[0] * settings_.time_step);
  for (BodyContacts& contacts : body_contacts_)
    contacts.note_travel(totals.maxima[0] * settings_.time_step);
  if (moved_ > 0.5 * settings_.skin) moved_ = ranks_.max(displacement());
  must_rebuild_ = moved_ > 0.5 * settings_.skin;
  return result;
}

double World::move_owned() {
  const double dt = settings_.time_step;
  double fastest2 = 0.0;
  for (std::size_t i = 0; i < owned_; ++i) {
    Particle& p = particles_[i];
    Vec3 gain = (dt / p.mass) * force_[i];
    gain.z -= dt * settings_.gravity;
    p.velocity += gain;
    p.position += dt * p.velocity;
    p.spin += (dt / (kSphereInertia * p.mass * p.radius * p.radius)) * moment_[i];
    const double speed2 = norm2(p.velocity);
    // The comparison is written so that a NaN takes over and stays.
    if (!(speed2 <= fastest2) && !std::isnan(fastest2)) fastest2 = speed2;
    if (!std::isfinite(moment_[i].x + moment_[i].y + moment_[i].z)) fastest2 = NAN;
  }
  return std::sqrt(fastest2);
}

double World::displacement() const {
  double largest2 = 0.0;
  for (std::size_t i = 0; i < owned_; ++i)
    largest2 = std::max(largest2, norm2(particles_[i].position - built_at_[i]));
  return std::sqrt(largest2);
}

bool World::has_lost_particle() const {
  const Vec3& low = settings_.low;
  const Vec3& high = settings_.high;
  for (std::size_t i = 0; i < owned_; ++i) {
    const Vec3& at = particles_[i].position;
    if (!(at.x >= low.x && at.y >= low.y && at.z >= low.z && at.x <= high.x && at.y <= high.y &&
          at.z <= high.z))
      return true;
  }
  return false;
}

void World::rebuild() {
  ContactRecords pair_records =
      waiting_pairs_ ? std::move(*waiting_pairs_) : pairs_.records(particles_);
  ContactRecords on_bodies = waiting_bodies_ ? std::move(*waiting_bodies_) : body_records();
  waiting_pairs_.reset();
  waiting_bodies_.reset();
  // Grains added since the last list have none yet.
  while (pair_records.particles() < owned_) pair_records.close_particle();
  while (on_bodies.particles() < owned_) on_bodies.close_particle();
  particles_.resize(owned_);  // drops ghosts

  migrate(pair_records, on_bodies);
  sort_owned(pair_records, on_bodies);
  built_at_.resize(owned_);
  for (std::size_t i = 0; i < owned_; ++i) built_at_[i] = particles_[i].position;
  // A hair more than the list's reach, so that rounding at a column's edge loses no pair.
  halo_.build(ranks_, columns_, (2.0 * settings_.largest_radius + settings_.skin) * (1.0 + 1e-9),
              particles_);
  pairs_.build(particles_, owned_, settings_.skin, pair_records);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    body_contacts_[b].build(particles_, owned_, bodies_[b], settings_.skin,
                            static_cast<std::int64_t>(b), on_bodies);
  must_rebuild_ = false;
  moved_ = 0.0;
  near_moved_ = 0.0;
}

ContactRecords World::body_records() const {
  const std::size_t width = body_contacts_.empty() ? 0 : body_contacts_[0].history_width();
  ContactRecords out(2, width);
  std::vector<std::size_t> at(body_contacts_.size(), 0);
  for (std::size_t i = 0; i < owned_; ++i) {
    for (std::size_t b = 0; b < body_contacts_.size(); ++b) {
      const auto& touches = body_contacts_[b].touches();
      for (; at[b] < touches.size() && touches[at[b]].particle == i; ++at[b]) {
        const std::int64_t names[2] = {static_cast<std::int64_t>(b), touches[at[b]].facet};
        out.add(names, body_contacts_[b].history(at[b]));
      }
    }
    out.close_particle();
  }
  return out;
}

void World::migrate(ContactRecords& pair_records, ContactRecords& body_records) {
  if (ranks_.size() == 1) return;
  std::vector<Bytes> out(static_cast<std::size_t>(ranks_.size()));
  ContactRecords kept_pairs(pair_records.name_width(), pair_records.value_width());
  ContactRecords kept_bodies(body_records.name_width(), body_records.value_width());
  std::vector<Particle> particles;
  std::vector<Vec3> origins;
  for (std::size_t i = 0; i < owned_; ++i) {
    const int owner = columns_.owner_of(particles_[i].position);
    if (owner == ranks_.rank()) {
      particles.push_back(particles_[i]);
      origins.push_back(origins_[i]);
      kept_pairs.copy_particle(pair_records, i);
      kept_bodies.copy_particle(body_records, i);
      continue;
    }
    Bytes& to = out[static_cast<std::size_t>(owner)];
    append_bytes(to, &particles_[i], 1);
    append_bytes(to, &origins_[i], 1);
    pair_records.pack(i, to);
    body_records.pack(i, to);
  }
  for (const Bytes& message : ranks_.exchange_all(out)) {
    ByteReader reader(message);
    while (!reader.empty()) {
      reader.take(&particles.emplace_back(), 1);
      reader.take(&origins.emplace_back(), 1);
      kept_pairs.unpack(reader);
      kept_bodies.unpack(reader);
    }
  }
  particles_ = std::move(particles);
  origins_ = std::move(origins);
  owned_ = particles_.size();
  pair_records = std::move(kept_pairs);
  body_records = std::move(kept_bodies);
}

void World::sort_owned(ContactRecords& pair_records, ContactRecords& body_records) {
  if (owned_ == 0) return;
  const CellGrid grid(settings_.low, settings_.high,
                      2.0 * settings_.largest_radius + settings_.skin, std::size_t{1} << 30);
  std::vector<std::size_t> cell(owned_);
  for (std::size_t i = 0; i < owned_; ++i)
    cell[i] = grid.index(grid.cell_of(particles_[i].position));
  std::vector<std::size_t> order(owned_);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(cell[a], particles_[a].id) < std::pair(cell[b], particles_[b].id);
  });
  std::vector<Particle> particles;
  std::vector<Vec3> origins;
  particles.reserve(owned_);
  origins.reserve(owned_);
  ContactRecords sorted_pairs(pair_records.name_width(), pair_records.value_width());
  ContactRecords sorted_bodies(body_records.name_width(), body_records.value_width());
  for (const std::size_t i : order) {
    particles.push_back(particles_[i]);
    origins.push_back(origins_[i]);
    sorted_pairs.copy_particle(pair_records, i);
    sorted_bodies.copy_particle(body_records, i);
  }
  particles_ = std::move(particles);
  origins_ = std::move(origins);
  pair_records = std::move(sorted_pairs);
  body_records = std::move(sorted_bodies);
}

double World::kinetic_energy() const {
  Communicator::StepTotals totals;
  totals.sums.resize(1);
  for (std::size_t i = 0; i < owned_; ++i) {
    const Particle& p = particles_[i];
    totals.sums[0].add(0.5 * p.mass *
                       (norm2(p.velocity) + kSphereInertia * p.radius * p.radius * norm2(p.spin)));
  }
  ranks_.combine(totals);
  return totals.sums[0].value();
}

std::int64_t World::contacts() const {
  std::int64_t local = pairs_.count();
  for (const BodyContacts& contacts : body_contacts_)
    local += static_cast<std::int64_t>(contacts.count());
  return ranks_.sum(local);
}

std::int64_t World::particle_count() const { return ranks_.sum(static_cast<std::int64_t>(owned_)); }

}  // namespace grouser
