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

void World::save_state(State& state) const {
  const std::int64_t total = particle_count();
  StateTable grains = particle_table();
  grains.key_count = total;
  for (std::size_t i = 0; i < owned_; ++i) {
    const Particle& p = particles_[i];
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
  StateTable touches;
  touches.name = "body_contacts";
  touches.key_count = total;
  touches.real_fields = contacts.real_fields;
  pairs_.each_history(
      particles_, [&](std::uint32_t grain, std::int64_t other, const double* values) {
        contacts.integers.insert(contacts.integers.end(), {particles_[grain].id, other});
        contacts.reals.insert(contacts.reals.end(), values, values + pairs_.history_width());
      });
  for (std::size_t b = 0; b < body_contacts_.size(); ++b) {
    const BodyContacts& on_body = body_contacts_[b];
    for (std::size_t t = 0; t < on_body.count(); ++t) {
      const BodyContacts::Touch& touch = on_body.touches()[t];
      const std::int64_t place = (static_cast<std::int64_t>(b) << kFacetBits) | touch.facet;
      touches.integers.insert(touches.integers.end(), {particles_[touch.particle].id, place});
      touches.reals.insert(touches.reals.end(), on_body.history(t),
                           on_body.history(t) + on_body.history_width());
    }
  }

  StateTable bodies = body_table();
  bodies.key_count = static_cast<std::int64_t>(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size() && ranks_.rank() == 0; ++b) {
    const BodyMotion& m = bodies_[b].motion;
    bodies.integers.insert(bodies.integers.end(), {static_cast<std::int64_t>(b), 0});
    push(bodies.reals, m.position);
    push(bodies.reals, m.velocity);
    bodies.reals.insert(bodies.reals.end(), {m.angle, m.spin});
  }
  for (StateTable* table : {&grains, &contacts, &touches, &bodies})
    state.push_back(std::move(*table));
}

void World::load_particles(const State& state) {
  StateTable grains = table_of(state, "particles");
  sort_rows(ranks_, grains);
  particles_.clear();
  origins_.clear();
  const double* from = grains.reals.data();
  for (std::size_t row = 0; row < grains.rows(); ++row) {
    Particle p;
    p.id = grains.integers[row * grains.integer_width()];
    p.position = pull(from);
    p.velocity = pull(from);
    p.spin = pull(from);
    p.radius = *from++;
    p.mass = *from++;
    particles_.push_back(p);
    origins_.push_back(pull(from));
  }
  owned_ = particles_.size();
  must_rebuild_ = true;
}

void World::load_contacts(const State& state) {
  StateTable contacts = table_of(state, "contacts");
  // Both grains of a contact may end on different ranks: each takes a copy under its own key.
  StateTable both = contacts;
  const std::size_t rw = contacts.real_width();
  const std::size_t iw = contacts.integer_width();
  GROUSER_CHECK(iw == 2);
  for (std::size_t row = 0; row < contacts.rows(); ++row) {
    both.integers.insert(both.integers.end(),
                         {contacts.integers[row * iw + 1], contacts.integers[row * iw]});
    both.reals.insert(both.reals.end(), contacts.reals.data() + row * rw,
                      contacts.reals.data() + (row + 1) * rw);
  }
  sort_rows(ranks_, both);
  StateTable touches = table_of(state, "body_contacts");
  sort_rows(ranks_, touches);

  // Fields are the same on every rank, so this is decided alike everywhere.
  if (pairs_.history_width() != rw || touches.real_width() != rw)
    throw FormatError("the checkpoint was written with other contact laws");
  pairs_.forget();
  for (BodyContacts& on_body : body_contacts_) on_body.forget();
  std::size_t pair = 0;
  std::size_t touch = 0;
  for (std::uint32_t i = 0; i < owned_; ++i) {  // rows and grains are both sorted by id here
    const std::int64_t id = particles_[i].id;
    for (; pair < both.rows() && both.integers[pair * 2] == id; ++pair)
      pairs_.keep(i, both.integers[pair * 2 + 1], both.reals.data() + pair * rw);
    for (; touch < touches.rows() && touches.integers[touch * 2] == id; ++touch) {
      const std::int64_t place = touches.integers[touch * 2 + 1];
      const auto body = static_cast<std::size_t>(place >> kFacetBits);
      // A body that the case does not have is noticed where bodies are loaded.
      if (body < body_contacts_.size())
        body_contacts_[body].keep(i, static_cast<int>(place & 0xFFFFFFFF),
                                  touches.reals.data() + touch * rw);
    }
  }
  const bool is_left_over = pair != both.rows() || touch != touches.rows();
  if (ranks_.max(std::int64_t{is_left_over ? 1 : 0}) != 0)
    throw FormatError("the checkpoint has contacts of grains that it does not have");
}

void World::load_state(const State& state) {
  load_particles(state);
  load_contacts(state);
  StateTable rows = table_of(state, "bodies");
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
