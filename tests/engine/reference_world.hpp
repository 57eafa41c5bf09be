// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "engine/core/particle.hpp"
#include "engine/dem/laws/hertz_mindlin.hpp"
#include "engine/dem/laws/rolling.hpp"

namespace grouser {

/// The plain way: every pair of grains in every step, in order of ids, histories in a map. No
/// lists, no cells, no ranks. The oracle of World.
class ReferenceWorld {
 public:
  ReferenceWorld(std::vector<Particle> grains, const Solid& solid, const Surface& surface,
                 double gravity, double time_step)
      : grains_(std::move(grains)),
        law_(HertzMindlin::from_parameters(solid, solid, surface)),
        rolling_(ElasticPlasticRolling::from_parameters(surface)),
        gravity_(gravity),
        time_step_(time_step) {
    std::sort(grains_.begin(), grains_.end(),
              [](const auto& a, const auto& b) { return a.id < b.id; });
  }

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
    at.normal = (1.0 / distance) * apart;
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
  HertzMindlin law_;
  ElasticPlasticRolling rolling_;
  double gravity_;
  double time_step_;
  std::map<std::pair<std::size_t, std::size_t>, Memory> memory_;
};

}  // namespace grouser
