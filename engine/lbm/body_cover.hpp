// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec3.hpp"

namespace grouser {

/// A closed surface of triangles as the cells of some rows see it. Through each row go kLines x
/// kLines lines along x, each at the middle of its share of the cells' sides; along a line the
/// covered part is exact. So a fraction is off by 1/(2 kLines) at most, where the surface is along
/// x, and by less elsewhere.
class BodyCover {
 public:
  static constexpr int kLines = 4;

  /// Rows [y_begin, y_end) x [z_begin, z_end) of the whole lattice.
  struct Rows {
    std::int64_t y_begin = 0;
    std::int64_t y_end = 0;
    std::int64_t z_begin = 0;
    std::int64_t z_end = 0;
  };

  /// @param corners  of the facets [cells] @param facets  three corners each; closed
  BodyCover(const std::vector<Vec3>& corners, const std::vector<std::array<int, 3>>& facets,
            const Rows& rows);

  /// Rows in which it covers anything.
  const Rows& rows() const { return rows_; }

  /// Cells [first, second) of a row that it may cover; none when second <= first. Local.
  std::pair<std::int64_t, std::int64_t> reach(std::int64_t y, std::int64_t z) const;
  /// Writes the covered fractions of `count` cells from `begin` on. Local.
  void cover(std::int64_t y, std::int64_t z, std::int64_t begin, std::int64_t count,
             float* fractions) const;

 private:
  struct Crossing {
    std::int64_t line;
    double x;
  };

  void cross(const std::vector<Vec3>& corners, const std::array<int, 3>& facet);
  std::int64_t line_of(std::int64_t across, std::int64_t up) const {
    return up * kLines * (rows_.y_end - rows_.y_begin) + across;
  }
  template <class Visit>
  void each_part(std::int64_t y, std::int64_t z, const Visit& visit) const;

  Rows rows_;
  std::vector<Crossing> crossings_;    // by line, then along it
  std::vector<std::uint32_t> starts_;  // of each line's crossings, and the end
};

}  // namespace grouser
