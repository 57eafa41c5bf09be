// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/body_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/dem/history_view.hpp"
#include "engine/dem/pair_contacts.hpp"

namespace grouser {
namespace {

// Grains closer to a body than this share of the skin are looked at in every step.
constexpr double kGap = 0.25;

}  // namespace

void BodyLoad::add(const BodyLoad& other) {
  force_x.add(other.force_x);
  force_y.add(other.force_y);
  force_z.add(other.force_z);
  force_moment_y.add(other.force_moment_y);
  couple_y.add(other.couple_y);
}

BodyContacts::BodyContacts(ContactLaw law, RollingLaw rolling, Threads threads)
    : law_(law),
      rolling_(rolling),
      threads_(threads),
      history_width_(grouser::history_width(law, rolling)) {}

void BodyContacts::keep(std::uint32_t grain, int facet, const double* values) {
  kept_.at.push_back({grain, facet});
  kept_.history.insert(kept_.history.end(), values, values + history_width_);
}

void BodyContacts::forget() {
  kept_.clear();
  parts_.clear();
}

std::size_t BodyContacts::count() const {
  std::size_t total = kept_.at.size();
  for (const Part& part : parts_) total += part.touches.at.size();
  return total;
}

// Parts follow one another in the order of grains.
void BodyContacts::collect() {
  for (const Part& part : parts_) {
    kept_.at.insert(kept_.at.end(), part.touches.at.begin(), part.touches.at.end());
    kept_.history.insert(kept_.history.end(), part.touches.history.begin(),
                         part.touches.history.end());
  }
  parts_.clear();
}

void BodyContacts::renumber(const std::vector<std::uint32_t>& number) {
  collect();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < kept_.at.size(); ++t) {
    const std::uint32_t grain = number[kept_.at[t].particle];
    if (grain == PairContacts::kGone) continue;
    kept_.at[kept] = {grain, kept_.at[t].facet};
    std::copy_n(kept_.history.begin() + static_cast<std::ptrdiff_t>(t * history_width_),
                history_width_,
                kept_.history.begin() + static_cast<std::ptrdiff_t>(kept * history_width_));
    ++kept;
  }
  kept_.at.resize(kept);
  kept_.history.resize(kept * history_width_);
}

void BodyContacts::build(const std::vector<Particle>& particles, std::size_t owned,
                         const Body& body, double skin) {
  skin_ = skin;
  std::vector<std::size_t> order(kept_.at.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(kept_.at[a].particle, kept_.at[a].facet) <
           std::pair(kept_.at[b].particle, kept_.at[b].facet);
  });
  Touches sorted;
  for (const std::size_t t : order) {
    const double* const history = kept_.history.data() + t * history_width_;
    sorted.at.push_back(kept_.at[t]);
    sorted.history.insert(sorted.history.end(), history, history + history_width_);
  }
  kept_ = std::move(sorted);
  look(particles, owned, body);
}

void BodyContacts::find_near(const std::vector<Particle>& particles, std::size_t owned,
                             const Body& body) {
  collect();
  look(particles, owned, body);
}

// Finds the grains near the body and gives each thread a part of them with the touches they have.
void BodyContacts::look(const std::vector<Particle>& particles, std::size_t owned,
                        const Body& body) {
  const BodyFrame frame(body.motion);
  std::vector<std::vector<std::uint32_t>> found(threads_.count());
  threads_.split(owned, [&](std::size_t first, std::size_t last, std::size_t share) {
    for (std::size_t i = first; i < last; ++i)
      if (body.search->may_be_near(frame.to_body(particles[i].position), body.turns))
        found[share].push_back(static_cast<std::uint32_t>(i));
  });
  near_.clear();
  for (const auto& some : found) near_.insert(near_.end(), some.begin(), some.end());

  parts_.resize(threads_.count());
  auto touch = kept_.at.begin();
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    part.first = share_begin(near_.size(), parts_.size(), p);
    part.last = share_begin(near_.size(), parts_.size(), p + 1);
    // Touches of grains that are not near any more can only have ended; any part may have them.
    const auto end = p + 1 == parts_.size() ? kept_.at.end()
                     : part.last == 0       ? touch
                                      : std::find_if(touch, kept_.at.end(), [&](const Touch& t) {
                                          return t.particle > near_[part.last - 1];
                                        });
    const auto history = kept_.history.begin();
    const auto width = static_cast<std::ptrdiff_t>(history_width_);
    part.touches.at.assign(touch, end);
    part.touches.history.assign(history + (touch - kept_.at.begin()) * width,
                                history + (end - kept_.at.begin()) * width);
    touch = end;
  }
  kept_.clear();
  gap_ = 0.0;
}

void BodyContacts::find_close(const std::vector<Particle>& particles, const Body& body,
                              Part& part) const {
  const BodyFrame frame(body.motion);
  part.close.clear();
  part.facets.clear();
  for (std::size_t n = part.first; n < part.last; ++n) {
    const std::uint32_t i = near_[n];
    const std::size_t before = part.facets.size();
    body.search->facets_within(frame.to_body(particles[i].position), particles[i].radius + gap_,
                               part.facets);
    if (part.facets.size() > before)
      part.close.push_back({i, static_cast<std::uint32_t>(part.facets.size() - before)});
  }
}

void BodyContacts::inherit(Part& part, std::size_t first, std::size_t last,
                           const MeshSearch& search) const {
  const std::vector<Touch>& before = part.touches.at;
  const std::vector<MeshTouch>& now = part.now;
  std::vector<double>& histories = part.histories;
  const auto history = [&](std::size_t touch) {
    return part.touches.history.data() + touch * history_width_;
  };
  if (now.size() == 1 && last - first == 1 && now[0].facet == before[first].facet) {
    histories.assign(history(first), history(first) + history_width_);
    return;
  }
  histories.assign(now.size() * history_width_, 0.0);
  std::vector<bool> is_taken(last - first, false);
  std::vector<bool> is_old(now.size(), false);
  const auto take = [&](std::size_t t, std::size_t old) {
    std::copy_n(history(old), history_width_,
                histories.begin() + static_cast<std::ptrdiff_t>(t * history_width_));
    is_taken[old - first] = true;
    is_old[t] = true;
  };
  for (std::size_t t = 0; t < now.size(); ++t)
    for (std::size_t old = first; old < last; ++old)
      if (before[old].facet == now[t].facet) take(t, old);
  // A touch that left its facet goes on across the edge.
  for (std::size_t t = 0; t < now.size(); ++t)
    for (std::size_t old = first; old < last && !is_old[t]; ++old)
      if (!is_taken[old - first] && search.are_neighbours(before[old].facet, now[t].facet))
        take(t, old);
}

void BodyContacts::carry_over(Part& part, std::size_t first, std::size_t last) const {
  const auto at = part.touches.at.begin();
  const auto history = part.touches.history.begin();
  const auto place = [&](std::size_t touch) {
    return history + static_cast<std::ptrdiff_t>(touch * history_width_);
  };
  part.next.at.insert(part.next.at.end(), at + static_cast<std::ptrdiff_t>(first),
                      at + static_cast<std::ptrdiff_t>(last));
  part.next.history.insert(part.next.history.end(), place(first), place(last));
}

template <class Law, class Rolling>
void BodyContacts::sweep(const Law& law, const Rolling& rolling,
                         const std::vector<Particle>& particles, const Body& body, double time_step,
                         Activity& activity, Part& part) const {
  using View = HistoryView<Law, Rolling>;
  const BodyFrame frame(body.motion);
  const Vec3 body_spin{0.0, body.motion.spin, 0.0};
  const std::vector<Touch>& touches = part.touches.at;
  std::vector<MeshTouch>& now = part.now;
  const bool is_at_rest = body.is_at_rest();
  BodyLoad load;
  double largest = 0.0;
  std::size_t before = 0;
  const int* facets = part.facets.data();
  for (const auto& [i, facet_count] : part.close) {
    const Particle& p = particles[i];
    const int* const near = facets;
    facets += facet_count;
    while (before < touches.size() && touches[before].particle < i) ++before;
    std::size_t after = before;
    while (after < touches.size() && touches[after].particle == i) ++after;
    const bool is_frozen = is_at_rest && activity.is_on() && activity.is_asleep(i);
    if (is_frozen) carry_over(part, before, after);
    if (is_frozen && !activity.is_wanted(i)) continue;
    now.clear();
    body.search->touches_of(frame.to_body(p.position), p.radius, near, facet_count, now);
    if (activity.is_on() && !is_at_rest && (after > before || !now.empty()))
      activity.note_moving_touch(i);
    if (now.empty()) continue;
    inherit(part, before, after, *body.search);
    for (std::size_t t = 0; t < now.size(); ++t) {
      const Vec3 point = frame.to_world(now[t].point);
      ContactPoint at;
      at.overlap = p.radius - now[t].distance;
      at.radius = p.radius;
      at.mass = p.mass;
      at.normal = (1.0 / now[t].distance) * (p.position - point);
      // Half an overlap inside either surface, as seen from the grain.
      const double reach = p.radius - 0.5 * at.overlap;
      const Vec3 arm = p.position - reach * at.normal - body.motion.position;
      const Vec3 velocity = p.velocity - body.motion.velocity - cross(body_spin, arm);
      at.normal_velocity = dot(velocity, at.normal);
      at.slip_velocity =
          velocity - at.normal_velocity * at.normal - reach * cross(p.spin, at.normal);
      const Vec3 spin = p.spin - body_spin;
      at.rolling_rate = spin - dot(spin, at.normal) * at.normal;

      typename Law::History contact_history;
      typename Rolling::History rolling_history;
      double* const stored = part.histories.data() + t * View::kWidth;
      View::load(stored, contact_history, rolling_history);
      const ContactForce result = law.evaluate(at, contact_history, time_step);
      const Vec3 turning = rolling.evaluate(at, result, rolling_history, time_step);
      View::store(stored, contact_history, rolling_history);

      const Vec3 on_grain = result.normal * at.normal + result.tangential;
      part.pushes.push_back({i, on_grain, reach * cross(result.tangential, at.normal) + turning});
      if (is_frozen) continue;
      load.force_x.add(-on_grain.x);
      load.force_y.add(-on_grain.y);
      load.force_z.add(-on_grain.z);
      load.force_moment_y.add(-cross(arm, on_grain).y);
      load.couple_y.add(-turning.y);
      largest = std::max(largest, at.overlap / p.radius);
      part.next.at.push_back({i, now[t].facet});
    }
    if (is_frozen) continue;
    part.next.history.insert(part.next.history.end(), part.histories.begin(), part.histories.end());
  }
  part.load = load;
  part.largest = largest;
}

double BodyContacts::sweep(const std::vector<Particle>& particles, const Body& body,
                           double time_step, Activity& activity, BodyLoad& load) {
  // The body has moved since the last step at the velocity it has now.
  travel_ +=
      (norm(body.motion.velocity) + std::abs(body.motion.spin) * body.search->rim()) * time_step;
  const bool is_out = travel_ * (1.0 + 1e-9) >= gap_;
  if (is_out) {
    gap_ = kGap * skin_;
    travel_ = 0.0;
  }
  threads_.run([&](std::size_t share) {
    Part& part = parts_[share];
    if (is_out) find_close(particles, body, part);
    part.pushes.clear();
    part.next.clear();
    std::visit(
        [&](const auto& law, const auto& rolling) {
          sweep(law, rolling, particles, body, time_step, activity, part);
        },
        law_, rolling_);
    std::swap(part.touches, part.next);
  });
  double largest = 0.0;
  for (const Part& part : parts_) {
    load.add(part.load);
    largest = std::max(largest, part.largest);
  }
  return largest;
}

}  // namespace grouser
