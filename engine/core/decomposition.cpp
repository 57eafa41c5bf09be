// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/decomposition.hpp"

#include <algorithm>

#include "base/columns.hpp"
#include "base/errors.hpp"

namespace grouser {

Decomposition::Decomposition(const Vec3& low, const Vec3& high, int size, int rank, double reach)
    : low_(low), high_(high) {
  const double length = high.x - low.x;
  const double width = high.y - low.y;
  const std::optional<Columns> found = cut_columns(length, width, size, reach);
  if (!found)
    throw ConfigError({Problem{"", 0, 0, "ranks",
                               std::to_string(size) +
                                   " ranks cut the box into columns narrower than the reach of a "
                                   "contact (" +
                                   std::to_string(reach) + " m)",
                               "use fewer ranks"}});
  columns_x_ = found->x;
  columns_y_ = found->y;
  at_x_ = rank / columns_y_;
  at_y_ = rank % columns_y_;
}

int Decomposition::owner_of(const Vec3& position) const {
  const auto index = [](double at, double low, double high, int count) {
    const double scaled = (at - low) / (high - low) * count;
    return static_cast<int>(std::clamp(scaled, 0.0, count - 1.0));
  };
  return index(position.x, low_.x, high_.x, columns_x_) * columns_y_ +
         index(position.y, low_.y, high_.y, columns_y_);
}

int Decomposition::neighbour(int step_x, int step_y) const {
  const int x = at_x_ + step_x;
  const int y = at_y_ + step_y;
  if (x < 0 || x >= columns_x_ || y < 0 || y >= columns_y_) return -1;
  return x * columns_y_ + y;
}

}  // namespace grouser
