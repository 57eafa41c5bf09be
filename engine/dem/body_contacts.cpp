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

BodyContacts::BodyContacts(ContactLaw law, RollingLaw rolling)
    : law_(law), rolling_(rolling), history_width_(grouser::history_width(law, rolling)) {}

void BodyContacts::keep(std::uint32_t grain, int facet, const double* values) {
  touches_.push_back({grain, facet});
  history_.insert(history_.end(), values, values + history_width_);
}

void BodyContacts::forget() {
  touches_.clear();
  history_.clear();
}

void BodyContacts::renumber(const std::vector<std::uint32_t>& number) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < touches_.size(); ++t) {
    const std::uint32_t grain = number[touches_[t].particle];
    if (grain == PairContacts::kGone) continue;
    touches_[kept] = {grain, touches_[t].facet};
    std::copy_n(history(t), history_width_,
                history_.begin() + static_cast<std::ptrdiff_t>(kept * history_width_));
    ++kept;
  }
  touches_.resize(kept);
  history_.resize(kept * history_width_);
}

void BodyContacts::build(const std::vector<Particle>& particles, std::size_t owned,
                         const Body& body, double skin) {
  skin_ = skin;
  std::vector<std::size_t> order(touches_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(touches_[a].particle, touches_[a].facet) <
           std::pair(touches_[b].particle, touches_[b].facet);
  });
  next_touches_.clear();
  next_history_.clear();
  for (const std::size_t t : order) {
    next_touches_.push_back(touches_[t]);
    next_history_.insert(next_history_.end(), history(t), history(t) + history_width_);
  }
  touches_.swap(next_touches_);
  history_.swap(next_history_);
  find_near(particles, owned, body);
}

void BodyContacts::find_near(const std::vector<Particle>& particles, std::size_t owned,
                             const Body& body) {
  const BodyFrame frame(body.motion);
  near_.clear();
  for (std::size_t i = 0; i < owned; ++i)
    if (body.search->may_be_near(frame.to_body(particles[i].position), body.turns))
      near_.push_back(static_cast<std::uint32_t>(i));
  gap_ = 0.0;
}

void BodyContacts::find_close(const std::vector<Particle>& particles, const Body& body) {
  const BodyFrame frame(body.motion);
  gap_ = kGap * skin_;
  travel_ = 0.0;
  close_.clear();
  facets_.clear();
  for (const std::uint32_t i : near_) {
    const std::size_t before = facets_.size();
    body.search->facets_within(frame.to_body(particles[i].position), particles[i].radius + gap_,
                               facets_);
    if (facets_.size() > before)
      close_.push_back({i, static_cast<std::uint32_t>(facets_.size() - before)});
  }
}

void BodyContacts::inherit(std::size_t first, std::size_t last, const MeshSearch& search,
                           const std::vector<MeshTouch>& now, std::vector<double>& histories) {
  if (now.size() == 1 && last - first == 1 && now[0].facet == touches_[first].facet) {
    histories.assign(history(first), history(first) + history_width_);
    return;
  }
  histories.assign(now.size() * history_width_, 0.0);
  std::vector<bool> is_taken(last - first, false);
  std::vector<bool> is_old(now.size(), false);
  const auto take = [&](std::size_t t, std::size_t before) {
    std::copy_n(history(before), history_width_,
                histories.begin() + static_cast<std::ptrdiff_t>(t * history_width_));
    is_taken[before - first] = true;
    is_old[t] = true;
  };
  for (std::size_t t = 0; t < now.size(); ++t)
    for (std::size_t before = first; before < last; ++before)
      if (touches_[before].facet == now[t].facet) take(t, before);
  // A touch that left its facet goes on across the edge.
  for (std::size_t t = 0; t < now.size(); ++t)
    for (std::size_t before = first; before < last && !is_old[t]; ++before)
      if (!is_taken[before - first] && search.are_neighbours(touches_[before].facet, now[t].facet))
        take(t, before);
}

template <class Law, class Rolling>
double BodyContacts::sweep(const Law& law, const Rolling& rolling,
                           const std::vector<Particle>& particles, const Body& body,
                           double time_step, BodyLoad& load) {
  using View = HistoryView<Law, Rolling>;
  const BodyFrame frame(body.motion);
  const Vec3 body_spin{0.0, body.motion.spin, 0.0};
  double largest = 0.0;
  std::size_t before = 0;
  std::vector<MeshTouch> now;
  std::vector<double> histories;
  const int* facets = facets_.data();
  for (const auto& [i, facet_count] : close_) {
    const Particle& p = particles[i];
    now.clear();
    body.search->touches_of(frame.to_body(p.position), p.radius, facets, facet_count, now);
    facets += facet_count;
    while (before < touches_.size() && touches_[before].particle < i) ++before;
    std::size_t after = before;
    while (after < touches_.size() && touches_[after].particle == i) ++after;
    if (now.empty()) continue;
    inherit(before, after, *body.search, now, histories);
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
      double* const stored = histories.data() + t * View::kWidth;
      View::load(stored, contact_history, rolling_history);
      const ContactForce result = law.evaluate(at, contact_history, time_step);
      const Vec3 turning = rolling.evaluate(at, result, rolling_history, time_step);
      View::store(stored, contact_history, rolling_history);

      const Vec3 on_grain = result.normal * at.normal + result.tangential;
      pushes_.push_back({i, on_grain, reach * cross(result.tangential, at.normal) + turning});
      load.force_x.add(-on_grain.x);
      load.force_y.add(-on_grain.y);
      load.force_z.add(-on_grain.z);
      load.force_moment_y.add(-cross(arm, on_grain).y);
      load.couple_y.add(-turning.y);
      largest = std::max(largest, at.overlap / p.radius);
      next_touches_.push_back({i, now[t].facet});
    }
    next_history_.insert(next_history_.end(), histories.begin(), histories.end());
  }
  return largest;
}

double BodyContacts::sweep(const std::vector<Particle>& particles, const Body& body,
                           double time_step, BodyLoad& load) {
  pushes_.clear();
  next_touches_.clear();
  next_history_.clear();
  // The body has moved since the last step at the velocity it has now.
  travel_ +=
      (norm(body.motion.velocity) + std::abs(body.motion.spin) * body.search->rim()) * time_step;
  if (travel_ * (1.0 + 1e-9) >= gap_) find_close(particles, body);
  const double largest = std::visit(
      [&](const auto& law, const auto& rolling) {
        return sweep(law, rolling, particles, body, time_step, load);
      },
      law_, rolling_);
  touches_.swap(next_touches_);
  history_.swap(next_history_);
  return largest;
}

}  // namespace grouser
