// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/pair_slots.hpp"

namespace grouser {

void PairSlots::add(const std::vector<Particle>& particles, std::size_t i, std::size_t j,
                    const double* history) {
  const std::size_t lane = size() % kLanes;
  if (lane == 0) {
    shape_.resize(shape_.size() + kShape * kLanes, 0.0);
    history_.resize(history_.size() + history_width_ * kLanes, 0.0);
    touching_.push_back(0);
  }
  if (particles[i].id > particles[j].id) std::swap(i, j);
  const Particle& a = particles[i];
  const Particle& b = particles[j];
  lower_.push_back(static_cast<std::uint32_t>(i) * kStride);
  higher_.push_back(static_cast<std::uint32_t>(j) * kStride);
  double* const shape = shape_.data() + shape_.size() - kShape * kLanes + lane;
  shape[0] = a.radius;
  shape[kLanes] = b.radius;
  shape[2 * kLanes] = a.radius * b.radius / (a.radius + b.radius);
  shape[3 * kLanes] = a.mass * b.mass / (a.mass + b.mass);
  if (history == nullptr) return;
  double* const own = history_.data() + history_.size() - history_width_ * kLanes + lane;
  for (std::size_t c = 0; c < history_width_; ++c) own[c * kLanes] = history[c];
  touching_.back() |= static_cast<std::uint8_t>(1u << lane);
}

void PairSlots::pad() {
  while (size() % kLanes != 0) {
    lower_.push_back(lower_.back());
    higher_.push_back(lower_.back());
  }
}

void PairSlots::clear() {
  lower_.clear();
  higher_.clear();
  shape_.clear();
  history_.clear();
  touching_.clear();
}

void PairSlots::history_of(std::size_t slot, double* values) const {
  const double* const pack =
      history_.data() + slot / kLanes * history_width_ * kLanes + slot % kLanes;
  for (std::size_t c = 0; c < history_width_; ++c) values[c] = pack[c * kLanes];
}

}  // namespace grouser
