// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "engine/core/exact_sum.hpp"
#include "engine/core/particle.hpp"
#include "engine/dem/body.hpp"
#include "engine/dem/laws/hertz_mindlin.hpp"
#include "engine/dem/laws/rolling.hpp"

namespace grouser {

/// The plain way: every pair of grains and every grain with every facet in every step, in order of
/// ids, histories in maps. No lists, no cells, no ranks. The oracle of World.
class ReferenceWorld {
 public:
  ReferenceWorld(std::vector<Particle> grains, const Solid& solid, const Surface& surface,
                 double gravity, double time_step)
      : grains_(std::move(grains)),
        solid_(solid),
        law_(HertzMindlin::from_parameters(solid, solid, surface)),
        rolling_(ElasticPlasticRolling::from_parameters(surface)),
        gravity_(gravity),
        time_step_(time_step) {
    std::sort(grains_.begin(), grains_.end(),
              [](const auto& a, const auto& b) { return a.id < b.id; });
  }

  /// Bodies are looked at in the order they are added in. @return its number
  std::size_t add_body(Mesh mesh, const Solid& solid, const Surface& surface) {
    bodies_.push_back({std::move(mesh),
                       HertzMindlin::from_parameters(solid_, solid, surface),
                       ElasticPlasticRolling::from_parameters(surface),
                       {},
                       {},
                       {}});
    return bodies_.size() - 1;
  }
  BodyMotion& motion(std::size_t body) { return bodies_[body].motion; }
  const ExactSum& force_z(std::size_t body) const { return bodies_[body].force_z; }
  /// Touches of grains with bodies in the last step, and those at an edge or a corner of a facet.
  std::size_t touches() const { return touches_; }
  std::size_t edge_touches() const { return edge_touches_; }

  void step() {
    std::vector<Vec3> force(grains_.size());
    std::vector<Vec3> moment(grains_.size());
    // Partner by partner for each grain, so that every sum runs in the order of ids.
    std::vector<Result> results(grains_.size() * grains_.size());
    for (std::size_t i = 0; i < grains_.size(); ++i)
      for (std::size_t j = i + 1; j < grains_.size(); ++j) touch(i, j, results);
    for (std::size_t i = 0; i < grains_.size(); ++i)
      for (std::size_t j = 0; j < grains_.size(); ++j) {
        const Result& r = results[std::min(i, j) * grains_.size() + std::max(i, j)];
        if (!r.is_touching) continue;
        const double arm = grains_[i].radius - r.half_overlap;
        if (i < j) {
          force[i] += r.force;
          moment[i] += arm * r.twist + r.moment;
        } else {
          force[i] -= r.force;
          moment[i] += arm * r.twist - r.moment;
        }
      }
    touches_ = edge_touches_ = 0;
    for (ReferenceBody& body : bodies_) {
      body.force_z = ExactSum{};
      for (std::size_t i = 0; i < grains_.size(); ++i) touch(i, body, force[i], moment[i]);
    }
    for (std::size_t i = 0; i < grains_.size(); ++i) {
      Particle& p = grains_[i];
      Vec3 gain = (time_step_ / p.mass) * force[i];
      gain.z -= time_step_ * gravity_;
      p.velocity += gain;
      p.position += time_step_ * p.velocity;
      p.spin += (time_step_ / (0.4 * p.mass * p.radius * p.radius)) * moment[i];
    }
  }

  const std::vector<Particle>& grains() const { return grains_; }  ///< by id

 private:
  struct Result {
    Vec3 force, twist, moment;
    double half_overlap = 0.0;
    bool is_touching = false;
  };
  struct Memory {
    HertzMindlin::History contact;
    ElasticPlasticRolling::History rolling;
  };

  struct FacetTouch {
    int facet = 0;
    Vec3 point;
    double distance = 0.0;
    unsigned feature = 0;
    Memory memory;
  };
  struct ReferenceBody {
    Mesh mesh;
    HertzMindlin law;
    ElasticPlasticRolling rolling;
    BodyMotion motion;
    ExactSum force_z;
    std::map<std::size_t, std::vector<FacetTouch>> memory;  // of the step before, by grain
  };

  static bool shares(const std::array<int, 3>& facet, int vertex) {
    return std::find(facet.begin(), facet.end(), vertex) != facet.end();
  }

  // Of all facets nearer than the radius, those whose nearest point is a local minimum of the
  // distance: no facet that the point also lies on has a nearer one. Of equal points the first.
  static std::vector<FacetTouch> touches_of(const Mesh& mesh, const Vec3& centre, double radius) {
    std::vector<FacetTouch> all, minima;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      const auto corner = [&](std::size_t k) {
        return mesh.vertices[static_cast<std::size_t>(mesh.facets[f][k])];
      };
      const NearestPoint near = nearest_on_triangle(centre, {corner(0), corner(1), corner(2)});
      const double distance = norm(centre - near.point);
      if (distance < radius)
        all.push_back({static_cast<int>(f), near.point, distance, near.feature, {}});
    }
    for (const FacetTouch& one : all) {
      const auto& own = mesh.facets[static_cast<std::size_t>(one.facet)];
      const bool is_beaten = std::any_of(all.begin(), all.end(), [&](const FacetTouch& other) {
        if (other.facet == one.facet) return false;
        if (norm(one.point - other.point) <= 1e-9 * radius) return other.facet < one.facet;
        const auto& facet = mesh.facets[static_cast<std::size_t>(other.facet)];
        bool lies_on = true;
        for (std::size_t k = 0; k < 3; ++k)
          if ((one.feature >> k & 1u) != 0) lies_on = lies_on && shares(facet, own[k]);
        return lies_on;
      });
      if (!is_beaten) minima.push_back(one);
    }
    return minima;
  }

  // A history stays with its facet, or goes on to one that shares a vertex.
  static void inherit(const Mesh& mesh, std::vector<FacetTouch> before,
                      std::vector<FacetTouch>& now) {
    std::vector<FacetTouch*> fresh;
    for (FacetTouch& touch : now) {
      const auto same = std::find_if(before.begin(), before.end(), [&](const FacetTouch& old) {
        return old.facet == touch.facet;
      });
      if (same == before.end()) {
        fresh.push_back(&touch);
        continue;
      }
      touch.memory = same->memory;
      before.erase(same);
    }
    for (FacetTouch* touch : fresh) {
      const auto next = std::find_if(before.begin(), before.end(), [&](const FacetTouch& old) {
        const auto& own = mesh.facets[static_cast<std::size_t>(touch->facet)];
        return std::any_of(own.begin(), own.end(), [&](int vertex) {
          return shares(mesh.facets[static_cast<std::size_t>(old.facet)], vertex);
        });
      });
      if (next == before.end()) continue;
      touch->memory = next->memory;
      before.erase(next);
    }
  }

  void touch(std::size_t i, ReferenceBody& body, Vec3& force, Vec3& moment) {
    const Particle& p = grains_[i];
    const BodyFrame frame(body.motion);
    const Vec3 body_spin{0.0, body.motion.spin, 0.0};
    std::vector<FacetTouch> now = touches_of(body.mesh, frame.to_body(p.position), p.radius);
    inherit(body.mesh, body.memory[i], now);
    for (FacetTouch& touch : now) {
      ContactPoint at;
      at.overlap = p.radius - touch.distance;
      at.radius = p.radius;
      at.mass = p.mass;
      at.normal = (1.0 / touch.distance) * (p.position - frame.to_world(touch.point));
      const double reach = p.radius - 0.5 * at.overlap;
      const Vec3 arm = p.position - reach * at.normal - body.motion.position;
      const Vec3 velocity = p.velocity - body.motion.velocity - cross(body_spin, arm);
      at.normal_velocity = dot(velocity, at.normal);
      at.slip_velocity =
          velocity - at.normal_velocity * at.normal - reach * cross(p.spin, at.normal);
      const Vec3 spin = p.spin - body_spin;
      at.rolling_rate = spin - dot(spin, at.normal) * at.normal;
      const ContactForce found = body.law.evaluate(at, touch.memory.contact, time_step_);
      const Vec3 turning = body.rolling.evaluate(at, found, touch.memory.rolling, time_step_);
      const Vec3 on_grain = found.normal * at.normal + found.tangential;
      force += on_grain;
      moment += reach * cross(found.tangential, at.normal) + turning;
      body.force_z.add(-on_grain.z);
      ++touches_;
      if (touch.feature != 7u) ++edge_touches_;
    }
    body.memory[i] = std::move(now);
  }

  void touch(std::size_t i, std::size_t j, std::vector<Result>& results) {
    const Particle& a = grains_[i];
    const Particle& b = grains_[j];
    const Vec3 apart = a.position - b.position;
    const double reach = a.radius + b.radius;
    if (norm2(apart) >= reach * reach) {
      memory_.erase({i, j});
      return;
    }
    const double distance = norm(apart);
    ContactPoint at;
    at.overlap = reach - distance;
    at.radius = a.radius * b.radius / reach;
    at.mass = a.mass * b.mass / (a.mass + b.mass);
    at.normal = (distance * (1.0 / norm2(apart))) * apart;
    const Vec3 velocity = a.velocity - b.velocity;
    at.normal_velocity = dot(velocity, at.normal);
    const double half = 0.5 * at.overlap;
    at.slip_velocity = velocity - at.normal_velocity * at.normal -
                       cross((a.radius - half) * a.spin + (b.radius - half) * b.spin, at.normal);
    const Vec3 spin = a.spin - b.spin;
    at.rolling_rate = spin - dot(spin, at.normal) * at.normal;
    Memory& memory = memory_[{i, j}];
    const ContactForce force = law_.evaluate(at, memory.contact, time_step_);
    Result r;
    r.moment = rolling_.evaluate(at, force, memory.rolling, time_step_);
    r.force = force.normal * at.normal + force.tangential;
    r.twist = cross(force.tangential, at.normal);
    r.half_overlap = half;
    r.is_touching = true;
    results[i * grains_.size() + j] = r;
  }

  std::vector<Particle> grains_;
  Solid solid_;
  HertzMindlin law_;
  ElasticPlasticRolling rolling_;
  double gravity_;
  double time_step_;
  std::map<std::pair<std::size_t, std::size_t>, Memory> memory_;
  std::vector<ReferenceBody> bodies_;
  std::size_t touches_ = 0;
  std::size_t edge_touches_ = 0;
};

}  // namespace grouser
