// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/halo.hpp"

namespace grouser {
namespace {

constexpr std::size_t kVectors = 3;  // position, velocity, spin

}  // namespace

void Halo::build(const Communicator& ranks, const Decomposition& columns, double reach,
                 std::vector<Particle>& particles) {
  for (std::size_t l = 0; l < legs_.size(); ++l) {
    const bool along_x = l < 2;
    const int step = l % 2 == 0 ? -1 : 1;
    Leg& leg = legs_[l];
    leg.to = along_x ? columns.neighbour(step, 0) : columns.neighbour(0, step);
    leg.from = along_x ? columns.neighbour(-step, 0) : columns.neighbour(0, -step);
    leg.sent.clear();
    // The second leg of a direction must not send back what the first brought.
    const std::size_t candidates = l % 2 == 0 ? particles.size() : legs_[l - 1].first_ghost;
    if (leg.to >= 0) {
      const double edge = along_x ? (step < 0 ? columns.low_x() : columns.high_x())
                                  : (step < 0 ? columns.low_y() : columns.high_y());
      for (std::size_t i = 0; i < candidates; ++i) {
        const double at = along_x ? particles[i].position.x : particles[i].position.y;
        if (step < 0 ? at < edge + reach : at > edge - reach)
          leg.sent.push_back(static_cast<std::uint32_t>(i));
      }
    }
    const std::int64_t sending = static_cast<std::int64_t>(leg.sent.size());
    std::int64_t coming = 0;
    ranks.shift(leg.to, &sending, sizeof sending, leg.from, &coming, sizeof coming);
    leg.first_ghost = particles.size();
    leg.ghosts = static_cast<std::size_t>(coming);
    std::vector<Particle> out;
    out.reserve(leg.sent.size());
    for (const std::uint32_t i : leg.sent) out.push_back(particles[i]);
    particles.resize(leg.first_ghost + leg.ghosts);
    ranks.shift(leg.to, out.data(), out.size() * sizeof(Particle), leg.from,
                particles.data() + leg.first_ghost, leg.ghosts * sizeof(Particle));
  }
}

void Halo::update(const Communicator& ranks, std::vector<Particle>& particles) {
  for (const Leg& leg : legs_) {
    if (leg.to < 0 && leg.from < 0) continue;
    out_.clear();
    for (const std::uint32_t i : leg.sent) {
      const Particle& p = particles[i];
      out_.insert(out_.end(), {p.position, p.velocity, p.spin});
    }
    in_.resize(leg.ghosts * kVectors);
    ranks.shift(leg.to, out_.data(), out_.size() * sizeof(Vec3), leg.from, in_.data(),
                in_.size() * sizeof(Vec3));
    for (std::size_t g = 0; g < leg.ghosts; ++g) {
      Particle& p = particles[leg.first_ghost + g];
      p.position = in_[g * kVectors];
      p.velocity = in_[g * kVectors + 1];
      p.spin = in_[g * kVectors + 2];
    }
  }
}

}  // namespace grouser
