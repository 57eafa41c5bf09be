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
  PopulationHalo(const Communicator& ranks, const CellBlocks& blocks)
      : ranks_(ranks), blocks_(blocks) {}

  /// Collective.
  void exchange(Streaming<Set, Real>& streaming) {
    constexpr int kLast = Set::kDimensions - 1;
    const bool outward = streaming.parity() == Parity::kOdd;
    for (int step = 1; step <= kLast; ++step) {
      const int axis = outward ? step : kLast + 1 - step;
      for (const int direction : {1, -1}) cross(streaming, axis, direction, outward);
    }
  }

 private:
  // Populations with c = direction along the axis belong to ghosts at that side and to cells of the
  // neighbour there at its other side.
  void cross(Streaming<Set, Real>& streaming, int axis, int direction, bool outward) {
    const int beyond = blocks_.neighbour(axis, direction);
    const int behind = blocks_.neighbour(axis, -direction);
    if (beyond < 0 && behind < 0) return;
    const std::int64_t ghost = direction > 0 ? blocks_.count(axis) : -1;
    const std::int64_t cell = direction > 0 ? 0 : blocks_.count(axis) - 1;
    Populations<Real>& populations = streaming.populations();
    std::vector<Real>& out = out_;
    std::vector<Real>& in = in_;
    copy(populations, axis, direction, outward ? cell : ghost, out, true);
    const int to = outward ? behind : beyond;
    const int from = outward ? beyond : behind;
    in.resize(out.size());
    if (to == ranks_.rank() && from == ranks_.rank()) {
      in.swap(out);
    } else {
      ranks_.shift(to, out.data(), out.size() * sizeof(Real), from, in.data(),
                   in.size() * sizeof(Real));
    }
    if (from >= 0) copy(populations, axis, direction, outward ? ghost : cell, in, false);
  }

  // Between a layer of the box, its ghosts in the other directions included, and a message.
  void copy(Populations<Real>& populations, int axis, int direction, std::int64_t layer,
            std::vector<Real>& message, bool pack) {
    const CellBox& box = populations.box();
    const std::int64_t rows = axis == 1 ? box.nz + 2 * box.ghosts_z : box.ny + 2;
    const auto length = static_cast<std::size_t>(box.nx + 2);
    if (pack) message.resize(crossing(axis) * static_cast<std::size_t>(rows) * length);
    Real* at = message.data();
    for (std::size_t i = 0; i < Set::kVelocities; ++i) {
      const LatticeVelocity c = Set::kSet.velocities[i];
      if ((axis == 1 ? c.y : c.z) != direction) continue;
      for (std::int64_t row = 0; row < rows; ++row, at += length) {
        Real* const cells =
            populations.of(i) + (axis == 1 ? populations.at(-1, layer, row - box.ghosts_z)
                                           : populations.at(-1, row - 1, layer));
        if (pack)
          std::memcpy(at, cells, length * sizeof(Real));
        else
          std::memcpy(cells, at, length * sizeof(Real));
      }
    }
  }

  static std::size_t crossing(int axis) {
    std::size_t count = 0;
    for (const LatticeVelocity c : Set::kSet.velocities) count += (axis == 1 ? c.y : c.z) == 1;
    return count;
  }

  Communicator ranks_;
  CellBlocks blocks_;
  std::vector<Real> out_;
  std::vector<Real> in_;
};

}  // namespace grouser
