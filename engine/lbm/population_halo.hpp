// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <vector>

#include "engine/lbm/streaming.hpp"

namespace grouser {

/// Brings what crossed the faces of a rank's block to where the step that is due looks for it: to
/// the neighbour's ghosts before an odd step, from its own ghosts back to the neighbour before an
/// even one. Only populations that cross a face are sent: 5 of 19. Edges follow because y goes
/// before z on the way out, with ghosts, and z before y on the way back.
template <class Set, class Real>
class PopulationHalo {
 public:
  /// Axes that are crossed, one stage after the other.
  static constexpr int kAxes = Set::kDimensions - 1;

  PopulationHalo(const Communicator& ranks, const CellBlocks& blocks)
      : ranks_(ranks), blocks_(blocks), messages_(ranks) {}

  /// Begins stage 0 ... kAxes - 1 for the step that is due. The rows next to faces must be done;
  /// others may be swept until end().
  void begin(Streaming<Set, Real>& streaming, int stage) {
    const bool outward = streaming.parity() == Parity::kOdd;
    for (const int direction : {1, -1}) {
      Crossing& c = crossing(direction);
      c.axis = outward ? 1 + stage : kAxes - stage;
      const int beyond = blocks_.neighbour(c.axis, direction);
      const int behind = blocks_.neighbour(c.axis, -direction);
      const std::int64_t ghost = direction > 0 ? blocks_.count(c.axis) : -1;
      const std::int64_t cell = direction > 0 ? 0 : blocks_.count(c.axis) - 1;
      // Populations with c = direction along the axis belong to ghosts at that side and to cells
      // of the neighbour there at its other side.
      c.to = outward ? behind : beyond;
      c.from = outward ? beyond : behind;
      c.from_layer = outward ? cell : ghost;
      c.to_layer = outward ? ghost : cell;
      c.out.resize(message_size(streaming.populations().box(), c.axis));
      c.in.resize(c.out.size());
      if (c.to >= 0) copy(streaming.populations(), c.axis, direction, c.from_layer, c.out, true);
      if (c.from >= 0 && c.from != ranks_.rank())
        messages_.receive(c.from, c.in.data(), c.in.size() * sizeof(Real));
    }
    for (const int direction : {1, -1}) {
      Crossing& c = crossing(direction);
      if (c.to == ranks_.rank()) c.in.swap(c.out);  // then it comes from this rank as well
      if (c.to >= 0 && c.to != ranks_.rank())
        messages_.send(c.to, c.out.data(), c.out.size() * sizeof(Real));
    }
  }

  /// Ends the stage begun last.
  void end(Streaming<Set, Real>& streaming) {
    messages_.finish();
    for (const int direction : {1, -1}) {
      Crossing& c = crossing(direction);
      if (c.from >= 0) copy(streaming.populations(), c.axis, direction, c.to_layer, c.in, false);
    }
  }

 private:
  // One direction's message on its way.
  struct Crossing {
    int axis = 1;
    int to = -1;
    int from = -1;
    std::int64_t from_layer = 0;
    std::int64_t to_layer = 0;
    std::vector<Real> out;
    std::vector<Real> in;
  };
  Crossing& crossing(int direction) { return crossings_[direction > 0 ? 0 : 1]; }

  static std::int64_t layer_rows(const CellBox& box, int axis) {
    return axis == 1 ? box.nz + 2 * box.ghosts_z : box.ny + 2;
  }

  // An even number: messages are whole words of eight bytes.
  static std::size_t message_size(const CellBox& box, int axis) {
    std::size_t populations = 0;
    for (const LatticeVelocity c : Set::kSet.velocities)
      populations += (axis == 1 ? c.y : c.z) == 1 ? 1 : 0;
    const std::int64_t cells = layer_rows(box, axis) * (box.nx + 2);
    return (populations * static_cast<std::size_t>(cells) + 1) / 2 * 2;
  }

  // Between a layer of the box, its ghosts in the other directions included, and a message.
  static void copy(Populations<Real>& populations, int axis, int direction, std::int64_t layer,
                   std::vector<Real>& message, bool pack) {
    const CellBox& box = populations.box();
    const auto length = static_cast<std::size_t>(box.nx + 2);
    Real* at = message.data();
    for (std::size_t i = 0; i < Set::kVelocities; ++i) {
      const LatticeVelocity c = Set::kSet.velocities[i];
      if ((axis == 1 ? c.y : c.z) != direction) continue;
      for (std::int64_t row = 0; row < layer_rows(box, axis); ++row, at += length) {
        const std::ptrdiff_t place = axis == 1 ? populations.at(-1, layer, row - box.ghosts_z)
                                               : populations.at(-1, row - 1, layer);
        Real* const cells = populations.of(i) + place;
        if (pack)
          std::memcpy(at, cells, length * sizeof(Real));
        else
          std::memcpy(cells, at, length * sizeof(Real));
      }
    }
  }

  Communicator ranks_;
  CellBlocks blocks_;
  Messages messages_;
  Crossing crossings_[2];
};

}  // namespace grouser
