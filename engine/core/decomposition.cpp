// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "base/check.hpp"

namespace grouser {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double along(const Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
double& along(Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// Gives boxes to `count` ranks from `first` on. `inner` is the part of the domain, whose edges are
// not at infinity.
void halve(const Box& inner, const Box& outer, int first, int count, std::vector<Box>& boxes) {
  if (count == 1) {
    boxes[static_cast<std::size_t>(first)] = outer;
    return;
  }
  int axis = 0;
  for (const int other : {1, 2})
    if (along(inner.high, other) - along(inner.low, other) >
        along(inner.high, axis) - along(inner.low, axis))
      axis = other;
  const int below = count / 2;
  const double at =
      along(inner.low, axis) + (along(inner.high, axis) - along(inner.low, axis)) * below / count;
  Box inner_below = inner, inner_above = inner, outer_below = outer, outer_above = outer;
  for (Box* box : {&inner_below, &outer_below}) along(box->high, axis) = at;
  for (Box* box : {&inner_above, &outer_above}) along(box->low, axis) = at;
  halve(inner_below, outer_below, first, below, boxes);
  halve(inner_above, outer_above, first + below, count - below, boxes);
}

}  // namespace

double Box::distance2(const Vec3& at) const {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double gap =
        std::max({along(low, axis) - along(at, axis), along(at, axis) - along(high, axis), 0.0});
    sum += gap * gap;
  }
  return sum;
}

double Box::distance2(const Box& other) const {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double gap = std::max({along(low, axis) - along(other.high, axis),
                                 along(other.low, axis) - along(high, axis), 0.0});
    sum += gap * gap;
  }
  return sum;
}

double Box::depth(const Vec3& at) const {
  return std::min(
      {at.x - low.x, high.x - at.x, at.y - low.y, high.y - at.y, at.z - low.z, high.z - at.z});
}

Decomposition::Decomposition(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
  GROUSER_CHECK(!boxes_.empty());
  std::vector<int> ranks(boxes_.size());
  std::iota(ranks.begin(), ranks.end(), 0);
  first_ = part(std::move(ranks));
}

Decomposition Decomposition::even(const Vec3& low, const Vec3& high, int count) {
  std::vector<Box> boxes(static_cast<std::size_t>(count));
  halve({low, high}, {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}}, 0, count, boxes);
  return Decomposition(std::move(boxes));
}

// Finds the plane that parts the boxes of these ranks most evenly, then those of each side.
int Decomposition::part(std::vector<int> ranks) {
  if (ranks.size() == 1) return -1 - ranks[0];
  std::size_t best = 0;
  int best_axis = 0;
  double best_at = 0.0;
  const auto low = [&](int rank, int axis) { return along(box(rank).low, axis); };
  const auto sort_along = [&](int axis) {
    // An empty box comes before what begins where it lies, whatever the order was before.
    std::sort(ranks.begin(), ranks.end(), [&](int a, int b) {
      return std::tuple(low(a, axis), along(box(a).high, axis), a) <
             std::tuple(low(b, axis), along(box(b).high, axis), b);
    });
  };
  const auto evenness = [&](std::size_t below) { return std::min(below, ranks.size() - below); };
  for (int axis = 0; axis < 3; ++axis) {
    sort_along(axis);
    double reached = -kFar;
    for (std::size_t k = 1; k < ranks.size(); ++k) {
      reached = std::max(reached, along(box(ranks[k - 1]).high, axis));
      if (reached > low(ranks[k], axis) || evenness(k) <= evenness(best)) continue;
      best = k;
      best_axis = axis;
      best_at = low(ranks[k], axis);
    }
  }
  GROUSER_CHECK(best > 0);
  sort_along(best_axis);
  const auto middle = ranks.begin() + static_cast<std::ptrdiff_t>(best);
  const std::vector<int> below(ranks.begin(), middle);
  const std::vector<int> above(middle, ranks.end());
  const auto place = static_cast<int>(cuts_.size());
  cuts_.push_back({best_axis, best_at, 0, 0});
  const int to_below = part(below);
  const int to_above = part(above);
  cuts_[static_cast<std::size_t>(place)].below = to_below;
  cuts_[static_cast<std::size_t>(place)].above = to_above;
  return place;
}

int Decomposition::owner_of(const Vec3& position) const {
  int at = first_;
  while (at >= 0) {
    const Cut& cut = cuts_[static_cast<std::size_t>(at)];
    at = along(position, cut.axis) < cut.at ? cut.below : cut.above;
  }
  return -1 - at;
}

std::vector<int> Decomposition::neighbours(int rank, double reach) const {
  std::vector<int> found;
  for (int other = 0; other < size(); ++other)
    if (other != rank && box(rank).distance2(box(other)) < reach * reach) found.push_back(other);
  return found;
}

}  // namespace grouser
