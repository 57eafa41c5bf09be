// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/communicator.hpp"
#include "engine/core/vec3.hpp"

namespace grouser {

/// Which rank owns which part of the domain: a regular grid of columns over x and y. The bed is
/// shallow, so z is not divided.
class Decomposition {
 public:
  /// @param low,high corners of the domain [m]; particles beyond belong to the nearest column
  /// @param reach    width of the halo [m]; columns must be at least as wide
  /// @throws ConfigError when `size` ranks would make columns narrower than `reach`. Local.
  Decomposition(const Vec3& low, const Vec3& high, int size, int rank, double reach);

  int owner_of(const Vec3& position) const;  ///< Local.

  int columns_x() const { return columns_x_; }
  int columns_y() const { return columns_y_; }
  /// Rank of the neighbouring column, or -1 at the edge of the domain.
  int neighbour(int step_x, int step_y) const;
  /// Edges of this rank's column [m].
  double low_x() const { return edge(low_.x, high_.x, columns_x_, at_x_); }
  double high_x() const { return edge(low_.x, high_.x, columns_x_, at_x_ + 1); }
  double low_y() const { return edge(low_.y, high_.y, columns_y_, at_y_); }
  double high_y() const { return edge(low_.y, high_.y, columns_y_, at_y_ + 1); }

 private:
  static double edge(double low, double high, int count, int index) {
    return low + (high - low) * index / count;
  }

  Vec3 low_;
  Vec3 high_;
  int columns_x_ = 1;
  int columns_y_ = 1;
  int at_x_ = 0;
  int at_y_ = 0;
};

}  // namespace grouser
