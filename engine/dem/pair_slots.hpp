// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/core/aligned.hpp"
#include "engine/core/pack.hpp"
#include "engine/core/particle.hpp"

namespace grouser {

/// Pairs that are looked at in each step, Pack::kLanes of them at a time, with their histories.
/// A pair is oriented from the grain with the higher id to that with the lower id.
class PairSlots {
 public:
  static constexpr std::size_t kLanes = Pack::kLanes;
  /// Numbers of a pair that do not change: both radii, effective radius, effective mass.
  static constexpr std::size_t kShape = 4;

  explicit PairSlots(std::size_t history_width) : history_width_(history_width) {}

  std::size_t size() const { return lower_.size(); }
  std::size_t packs() const { return touching_.size(); }

  /// Adds the pair of grains `i` and `j`. @param history of a touching pair, else null
  void add(const std::vector<Particle>& particles, std::size_t i, std::size_t j,
           const double* history);
  /// Fills the last pack up with a grain against itself, without a radius: it never touches.
  void pad();
  void clear();
  /// Frees what find() and history_of() do not need.
  void free_shapes() { LineVector<double>().swap(shape_); }

  std::uint32_t lower(std::size_t slot) const { return lower_[slot] / kStride; }
  std::uint32_t higher(std::size_t slot) const { return higher_[slot] / kStride; }
  bool is_padding(std::size_t slot) const { return lower_[slot] == higher_[slot]; }
  bool is_touching(std::size_t slot) const {
    return (touching_[slot / kLanes] >> (slot % kLanes) & 1u) != 0;
  }
  void history_of(std::size_t slot, double* values) const;

  /// The two grains of a pack's first pair and of those that follow, as places of their first
  /// number among all numbers of all grains.
  const std::uint32_t* lower_places(std::size_t slot) const { return &lower_[slot]; }
  const std::uint32_t* higher_places(std::size_t slot) const { return &higher_[slot]; }
  const double* shapes(std::size_t slot) const { return shape_.data() + slot * kShape; }
  double* histories(std::size_t slot) { return history_.data() + slot * history_width_; }
  std::uint8_t& touching(std::size_t slot) { return touching_[slot / kLanes]; }

 private:
  // Saves the sweep a multiplication per grain and use.
  static constexpr auto kStride = static_cast<std::uint32_t>(kGrainStride);

  std::size_t history_width_;
  std::vector<std::uint32_t> lower_;
  std::vector<std::uint32_t> higher_;
  LineVector<double> shape_;            // packs of kShape numbers
  LineVector<double> history_;          // packs of history_width_ numbers
  std::vector<std::uint8_t> touching_;  // of each pack, bit k = lane k
};

}  // namespace grouser
