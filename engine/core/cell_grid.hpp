// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/vec3.hpp"

namespace grouser {

/// Boxes of equal size over a region, numbered x-major.
class CellGrid {
 public:
  /// @param size smallest edge of a cell [m]; edges grow where `limit` cells would not do
  CellGrid(const Vec3& low, const Vec3& high, double size, std::size_t limit) : low_(low) {
    const std::array<double, 3> span{high.x - low.x, high.y - low.y, high.z - low.z};
    std::array<double, 3> edge{size, size, size};
    for (;;) {
      double cells = 1.0;
      std::size_t longest = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        const double along = std::max(1.0, std::floor(span[d] / edge[d]));
        cells *= along;
        if (span[d] / edge[d] > span[longest] / edge[longest]) longest = d;
        if (along <= 1e9) count_[d] = static_cast<int>(along);
      }
      if (cells <= static_cast<double>(limit) || span[longest] / edge[longest] <= 1.0) break;
      edge[longest] *= 1.5;
    }
    for (std::size_t d = 0; d < 3; ++d) scale_[d] = span[d] > 0.0 ? count_[d] / span[d] : 0.0;
  }

  int count(std::size_t dimension) const { return count_[dimension]; }
  std::size_t cells() const { return index({count_[0] - 1, count_[1] - 1, count_[2] - 1}) + 1; }

  /// Cell of a point; points outside belong to the nearest cell.
  std::array<int, 3> cell_of(const Vec3& at) const {
    return {clamped((at.x - low_.x) * scale_[0], 0), clamped((at.y - low_.y) * scale_[1], 1),
            clamped((at.z - low_.z) * scale_[2], 2)};
  }
  std::size_t index(const std::array<int, 3>& cell) const {
    return (static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(count_[1]) +
            static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(count_[2]) +
           static_cast<std::size_t>(cell[2]);
  }
  Vec3 centre(const std::array<int, 3>& cell) const {
    return {low_.x + (cell[0] + 0.5) / scale_[0], low_.y + (cell[1] + 0.5) / scale_[1],
            low_.z + (cell[2] + 0.5) / scale_[2]};
  }

 private:
  int clamped(double scaled, std::size_t d) const {
    return static_cast<int>(std::clamp(scaled, 0.0, count_[d] - 1.0));
  }

  Vec3 low_;
  std::array<int, 3> count_{1, 1, 1};
  std::array<double, 3> scale_{};
};

}  // namespace grouser
