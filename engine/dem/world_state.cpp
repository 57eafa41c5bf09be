// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "base/check.hpp"
#include "base/errors.hpp"
#include "engine/dem/world.hpp"

namespace grouser {
namespace {

void push(std::vector<double>& to, const Vec3& v) { to.insert(to.end(), {v.x, v.y, v.z}); }

Vec3 pull(const double*& from) {
  const Vec3 v{from[0], from[1], from[2]};
  from += 3;
  return v;
}

// A touch's place in a table: body and facet in one number.
constexpr std::int64_t kFacetBits = 32;

StateTable particle_table() {
  StateTable table;
  table.name = "particles";
  table.real_fields = {{"position", "m", 3}, {"velocity", "m s-1", 3}, {"spin", "rad s-1", 3},
                       {"radius", "m", 1},   {"mass", "kg", 1},        {"origin", "m", 3}};
  return table;
}

StateTable body_table() {
  StateTable table;
  table.name = "bodies";
  table.real_fields = {
      {"position", "m", 3}, {"velocity", "m s-1", 3}, {"angle", "rad", 1}, {"spin", "rad s-1", 1}};
  return table;
}

}  // namespace

void World::save_state(State& state, const StatePiece& piece) const {
  const std::int64_t total = particle_count();
  StateTable grains = particle_table();
  grains.key_count = total;
  grains.all_rows = total;
  const std::size_t share = owned_ / static_cast<std::size_t>(piece.count);
  grains.integers.reserve(share * grains.integer_width());
  grains.reals.reserve(share * grains.real_width());
  for (std::size_t i = 0; i < owned_; ++i) {
    const Particle& p = particles_[i];
    if (!piece.has(p.id, total)) continue;
    grains.integers.insert(grains.integers.end(), {p.id, 0});
    push(grains.reals, p.position);
    push(grains.reals, p.velocity);
    push(grains.reals, p.spin);
    grains.reals.insert(grains.reals.end(), {p.radius, p.mass});
    push(grains.reals, origins_[i]);
  }

  StateTable contacts;
  contacts.name = "contacts";
  contacts.key_count = total;
  contacts.real_fields = pairs_.history_fields();
  std::int64_t rows = 0;
  pairs_.each_history(
      particles_, [&](std::uint32_t grain, std::int64_t other, const double* values) {
        ++rows;
        const std::int64_t id = particles_[grain].id;
        if (!piece.has(id, total)) return;
        contacts.integers.insert(contacts.integers.end(), {id, other});
        contacts.reals.insert(contacts.reals.end(), values, values + pairs_.history_width());
      });
  contacts.all_rows = ranks_.sum(rows);

  StateTable touches;
  touches.name = "body_contacts";
  touches.key_count = total;
  touches.real_fields = contacts.real_fields;
  rows = 0;
  for (std::size_t b = 0; b < body_contacts_.size(); ++b) {
    const BodyContacts& on_body = body_contacts_[b];
    rows += static_cast<std::int64_t>(on_body.count());
    on_body.each_touch(0, owned_, [&](std::uint32_t grain, int facet, const double* history) {
      const std::int64_t id = particles_[grain].id;
      if (!piece.has(id, total)) return;
      const std::int64_t place = (static_cast<std::int64_t>(b) << kFacetBits) | facet;
      touches.integers.insert(touches.integers.end(), {id, place});
      touches.reals.insert(touches.reals.end(), history, history + on_body.history_width());
    });
  }
  touches.all_rows = ranks_.sum(rows);

  StateTable bodies = body_table();
  bodies.key_count = bodies.all_rows = static_cast<std::int64_t>(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size() && ranks_.rank() == 0; ++b) {
    if (!piece.has(static_cast<std::int64_t>(b), bodies.key_count)) continue;
    const BodyMotion& m = bodies_[b].motion;
    bodies.integers.insert(bodies.integers.end(), {static_cast<std::int64_t>(b), 0});
    push(bodies.reals, m.position);
    push(bodies.reals, m.velocity);
    bodies.reals.insert(bodies.reals.end(), {m.angle, m.spin});
  }
  for (StateTable* table : {&grains, &contacts, &touches, &bodies})
    state.push_back(std::move(*table));
  activity_.save_state(ranks_, state, piece);
}

void World::begin_load() {
  particles_.clear();
  origins_.clear();
  owned_ = 0;
  pairs_.forget();
  for (BodyContacts& on_body : body_contacts_) on_body.forget();
  load_failure_.clear();
  must_rebuild_ = true;
  may_be_far_ = true;
  is_new_ = true;
}

void World::load_rows(const StateTable& rows) {
  if (rows.name == "particles") load_particles(rows);
  if (rows.name == "contacts") load_pairs(rows);
  if (rows.name == "body_contacts") load_touches(rows);
  if (rows.name == "bodies") load_bodies(rows);
  activity_.load_rows(ranks_, rows);
}

void World::end_load() {
  count_ = particle_count();
  for (std::uint32_t i = 0; i < owned_ && load_failure_.empty(); ++i)
    if (loaded_grain(particles_[i].id) != i) load_failure_ = "a grain is there twice or not at all";
  if (ranks_.max(std::int64_t{load_failure_.empty() ? 0 : 1}) == 0) return;
  throw FormatError("the checkpoint does not fit together: " +
                    (load_failure_.empty() ? "rows of another rank" : load_failure_));
}

// While a state is loaded each rank has one block of ids, in order.
std::optional<std::uint32_t> World::loaded_grain(std::int64_t id) const {
  if (owned_ == 0 || id < particles_[0].id ||
      id - particles_[0].id >= static_cast<std::int64_t>(owned_))
    return std::nullopt;
  return static_cast<std::uint32_t>(id - particles_[0].id);
}

void World::load_particles(StateTable rows) {
  if (particles_.empty()) reserve(static_cast<std::size_t>(rows.key_count / ranks_.size() + 1));
  sort_rows(ranks_, rows);
  const double* from = rows.reals.data();
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    Particle p;
    p.id = rows.integers[row * rows.integer_width()];
    p.position = pull(from);
    p.velocity = pull(from);
    p.spin = pull(from);
    p.radius = *from++;
    p.mass = *from++;
    add_particle(p);
    origins_.back() = pull(from);
  }
}

// Both grains of a pair may be on different ranks, or come to be: each takes a copy under its key.
void World::load_pairs(const StateTable& rows) {
  const std::size_t width = rows.real_width();
  // Fields are the same on every rank, so this is decided alike everywhere.
  if (width != pairs_.history_width())
    throw FormatError("the checkpoint was written with other contact laws");
  StateTable both = rows;
  GROUSER_CHECK(rows.integer_width() == 2);
  for (std::size_t row = 0; row < rows.rows() && ranks_.size() > 1; ++row) {
    both.integers.insert(both.integers.end(), {rows.integers[row * 2 + 1], rows.integers[row * 2]});
    both.reals.insert(both.reals.end(), rows.reals.data() + row * width,
                      rows.reals.data() + (row + 1) * width);
  }
  sort_rows(ranks_, both);
  for (std::size_t row = 0; row < both.rows(); ++row) {
    const auto grain = loaded_grain(both.integers[row * 2]);
    if (grain) {
      pairs_.keep(*grain, both.integers[row * 2 + 1], both.reals.data() + row * width);
    } else {
      load_failure_ = "a contact of a grain that is not there";
    }
  }
}

void World::load_touches(StateTable rows) {
  const std::size_t width = rows.real_width();
  if (width != pairs_.history_width())
    throw FormatError("the checkpoint was written with other contact laws");
  sort_rows(ranks_, rows);
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    const auto grain = loaded_grain(rows.integers[row * 2]);
    const std::int64_t place = rows.integers[row * 2 + 1];
    const auto body = static_cast<std::size_t>(place >> kFacetBits);
    if (grain && body < body_contacts_.size()) {
      body_contacts_[body].keep(*grain,
                                static_cast<int>(place & ((std::int64_t{1} << kFacetBits) - 1)),
                                rows.reals.data() + row * width);
    } else {
      load_failure_ = "a contact of a grain or body that is not there";
    }
  }
}

void World::load_bodies(const StateTable& rows) {
  // Few rows: every rank needs them all.
  std::vector<Bytes> out(static_cast<std::size_t>(ranks_.size()));
  for (Bytes& to : out)
    for (std::size_t row = 0; row < rows.rows(); ++row) {
      append_bytes(to, &rows.integers[row * 2], 2);
      append_bytes(to, rows.reals.data() + row * rows.real_width(), rows.real_width());
    }
  for (const Bytes& message : ranks_.exchange_all(out)) {
    ByteReader reader(message);
    while (!reader.empty()) {
      std::int64_t names[2];
      double values[8];
      reader.take(names, 2);
      reader.take(values, 8);
      // A bed's checkpoint knows fewer bodies than the run that starts from it.
      if (names[0] < 0 || static_cast<std::size_t>(names[0]) >= bodies_.size())
        throw FormatError("the checkpoint has a body that the case does not have");
      BodyMotion& m = bodies_[static_cast<std::size_t>(names[0])].motion;
      m.position = {values[0], values[1], values[2]};
      m.velocity = {values[3], values[4], values[5]};
      m.angle = values[6];
      m.spin = values[7];
    }
  }
}

}  // namespace grouser
