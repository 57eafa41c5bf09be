// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/body_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/dem/history_view.hpp"
#include "engine/dem/pair_contacts.hpp"
#include "engine/dem/touch_pack.hpp"

namespace grouser {
namespace {

// Grains closer to a body than this share of the skin are looked at in every step.
constexpr double kGap = 0.25;

// Grains between fetching one and using it: those near a body are far from each other in memory.
constexpr std::size_t kAhead = 8;

[[gnu::always_inline]] inline void fetch(const Particle& particle) {
  __builtin_prefetch(&particle);
  __builtin_prefetch(&particle.id);
}

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

// Leaves the touches of this step in part.next, and those whose forces are wanted in part.acting
// with the histories that they go on from.
void BodyContacts::find_touches(const std::vector<Particle>& particles, const Body& body,
                                Activity& activity, Part& part) const {
  const BodyFrame frame(body.motion);
  const std::vector<Touch>& touches = part.touches.at;
  std::vector<MeshTouch>& now = part.now;
  const bool is_at_rest = body.is_at_rest();
  std::size_t before = 0;
  const int* facets = part.facets.data();
  part.next.clear();
  part.acting.clear();
  part.acting_history.clear();
  part.nearest.clear();
  for (std::size_t c = 0; c < part.close.size(); ++c) {
    const auto& [i, facet_count] = part.close[c];
    fetch(particles[part.close[std::min(c + kAhead, part.close.size() - 1)].particle]);
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
    for (const MeshTouch& touch : now) {
      const Vec3 point = frame.to_world(touch.point);
      part.nearest.insert(part.nearest.end(), {point.x, point.y, point.z, touch.distance});
      part.acting.push_back({i, is_frozen ? kFrozen : part.next.at.size()});
      if (!is_frozen) part.next.at.push_back({i, touch.facet});
    }
    part.acting_history.insert(part.acting_history.end(), part.histories.begin(),
                               part.histories.end());
    // Filled when the touches have acted.
    part.next.history.resize(part.next.at.size() * history_width_);
  }
}

// Evaluates part.acting, Pack::kLanes touches at a time.
template <class Law, class Rolling>
void BodyContacts::act(const Law& law, const Rolling& rolling,
                       const std::vector<Particle>& particles, const Body& body, double time_step,
                       Part& part) const {
  const std::size_t count = part.acting.size();
  part.pushes.resize((count + Pack::kLanes) * kGrainLoad);
  BodyLoad load;
  part.largest = 0.0;
  for (std::size_t first = 0; first < count; first += Pack::kLanes) {
    TouchPack<Law, Rolling> pack;
    for (std::size_t lane = 0; lane < Pack::kLanes; ++lane) {
      // Lanes behind the last touch repeat it.
      const std::size_t t = std::min(first + lane, count - 1);
      pack.grain[lane] = &particles[part.acting[t].particle].position.x;
      pack.nearest[lane] = &part.nearest[4 * t];
      pack.set_history(lane, &part.acting_history[t * history_width_]);
    }
    pack.act(law, rolling, body.motion, time_step, &part.pushes[first * kGrainLoad]);
    for (std::size_t lane = 0; lane < std::min(Pack::kLanes, count - first); ++lane) {
      const std::size_t place = part.acting[first + lane].place;
      if (place == kFrozen) continue;
      pack.get_history(lane, &part.next.history[place * history_width_]);
      const double* const push = &part.pushes[(first + lane) * kGrainLoad];
      load.force_x.add(-push[0]);
      load.force_y.add(-push[1]);
      load.force_z.add(-push[2]);
      load.force_moment_y.add(-pack.force_moment_y[lane]);
      load.couple_y.add(-pack.couple_y[lane]);
      part.largest = std::max(part.largest, pack.share[lane]);
    }
  }
  part.load = load;
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
    find_touches(particles, body, activity, part);
    std::visit([&](const auto& law,
                   const auto& rolling) { act(law, rolling, particles, body, time_step, part); },
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
