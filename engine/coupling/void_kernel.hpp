// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/lbm/cell_blocks.hpp"

namespace grouser {

/// How a grain is spread over the cells around it, and what cells hold is read where it is: the
/// quadratic spline, three cells wide along each axis, smooth where a grain passes from cell to
/// cell. The shares add up to one; those beyond a wall are given to the cell before it, so that
/// nothing is lost. Along one axis.
struct KernelAxis {
  /// Cells of the shares, -1 or n where they lie beyond a periodic end.
  std::array<std::int64_t, 3> cell{};
  std::array<double, 3> share{};  ///< adds up to one

  /// @param place   of the grain, in cells from the centre of cell 0
  /// @param cells   of the lattice along the axis
  KernelAxis(double place, std::int64_t cells, bool periodic) {
    const auto last = static_cast<double>(cells - 1);
    double nearest = std::floor(place + 0.5);
    if (!periodic) nearest = std::clamp(nearest, 0.0, last);
    const double off = std::clamp(place - nearest, -0.5, 0.5);
    const auto middle = static_cast<std::int64_t>(nearest);
    for (int k = 0; k < 3; ++k) {
      std::int64_t at = middle + k - 1;
      if (!periodic) at = std::clamp<std::int64_t>(at, 0, cells - 1);
      cell[static_cast<std::size_t>(k)] = at;
    }
    share = {0.5 * (0.5 - off) * (0.5 - off), 0.75 - off * off, 0.5 * (0.5 + off) * (0.5 + off)};
  }

  std::int64_t middle() const { return cell[1]; }
};

/// A grain's shares in the 27 cells around it.
class Kernel {
 public:
  /// @param place of the grain in cells from the centre of cell (0, 0, 0); within one length of a
  ///              periodic lattice
  Kernel(const Vec3& place, const CellBlocks& blocks)
      : axes_{KernelAxis(place.x, blocks.cells()[0], blocks.periodic(0)),
              KernelAxis(place.y, blocks.cells()[1], blocks.periodic(1)),
              KernelAxis(place.z, blocks.cells()[2], blocks.periodic(2))} {}

  const KernelAxis& axis(std::size_t a) const { return axes_[a]; }

  /// visit(x, y, z, share) for each of the 27 cells, in a fixed order.
  template <class Visit>
  void each(const Visit& visit) const {
    const auto& [x, y, z] = axes_;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i)
          visit(x.cell[i], y.cell[j], z.cell[k], x.share[i] * y.share[j] * z.share[k]);
  }

 private:
  std::array<KernelAxis, 3> axes_;
};

}  // namespace grouser
