// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "engine/lbm/lattice.hpp"
#include "engine/lbm/wide.hpp"

namespace grouser {

/// Radius whose planes give a ball of radius R the volume it has: with R'^3 + R'/4 = R^3 the sum of
/// all fractions is 4/3 pi R^3 on the average over places of the centre. Cells at a curved surface
/// hold less than the tangent plane cuts off; R' is about R - 1/(12 R). Local.
inline double cover_radius(double radius) {
  double r = radius;
  for (int i = 0; i < 8; ++i)
    r -= (r * r * r + 0.25 * r - radius * radius * radius) / (3.0 * r * r + 0.25);
  return r;
}

/// Half of a cell's diagonal: further from a plane than this a cell is whole or empty.
inline constexpr double kHalfDiagonal = 0.8660254037844386;

/// The share of a unit cube that lies behind a plane whose normal is along (x, y, z), all not
/// negative and not all zero; `depth` is how far the cube's centre lies behind it.
/// A component under a fiftieth of the normal counts as that, which is off by under 0.01.
/// Source: Scardovelli, Zaleski 2000, eq. 3.
template <class T>
[[gnu::always_inline]] inline T cube_behind_plane(T x, T y, T z, T depth) {
  const auto larger = [](const T& a, const T& b) GROUSER_INLINE { return a > b ? a : b; };
  const auto smaller = [](const T& a, const T& b) GROUSER_INLINE { return a < b ? a : b; };
  const auto cube = [](const T& a) GROUSER_INLINE { return a * a * a; };
  const T none = depth - depth;
  const T least = none + 0.02f;
  x = larger(x, least);
  y = larger(y, least);
  z = larger(z, least);
  const T width = x + y + z;
  const T reach = depth + width * 0.5f;
  // The share on the emptier side, from its corner on.
  const T t = larger(smaller(reach, width - reach), none);
  const auto beyond = [&](const T& by) GROUSER_INLINE { return cube(larger(t - by, none)); };
  const T sum =
      cube(t) - beyond(x) - beyond(y) - beyond(z) + beyond(x + y) + beyond(x + z) + beyond(y + z);
  const T share = sum / (x * y * z * 6.0f);
  return reach + reach > width ? 1.0f - share : share;
}

/// A ball as cells see it.
struct BallRow {
  double x = 0.0;  ///< of the centre
  double y = 0.0;  ///< of the row from the centre
  double z = 0.0;
  double radius = 0.0;  ///< see cover_radius

  /// Cells from begin to end - 1 of the row may be covered; none when end <= begin.
  struct Reach {
    std::int64_t begin = 0;
    std::int64_t end = 0;
  };
  Reach reach() const {
    const double outer = radius + kHalfDiagonal;
    const double half2 = outer * outer - y * y - z * z;
    if (half2 <= 0.0) return {};
    const double half = std::sqrt(half2);
    return {static_cast<std::int64_t>(std::ceil(x - half)),
            static_cast<std::int64_t>(std::floor(x + half)) + 1};
  }

  /// Writes the covered fractions of `count` cells from `begin` on, a multiple of the lanes: the
  /// share behind the plane that touches the surface next to the cell's centre. Local.
  void cover(std::int64_t begin, std::int64_t count, float* fractions) const {
    using Lanes = Wide<float>;
    constexpr auto kLanes = static_cast<std::int64_t>(WideOf<float>::kLanes);
    const double inner = radius - kHalfDiagonal;
    const double half2 = inner > 0.0 ? inner * inner - y * y - z * z : -1.0;
    const double half = half2 > 0.0 ? std::sqrt(half2) : -1.0;
    const Lanes across = Lanes{} + std::abs(static_cast<float>(y));
    const Lanes up = Lanes{} + std::abs(static_cast<float>(z));
    const auto aside2 = static_cast<float>(y * y + z * z);
    Lanes steps{};
    for (std::size_t i = 0; i < WideOf<float>::kLanes; ++i) steps[i] = static_cast<float>(i);
    for (std::int64_t at = 0; at < count; at += kLanes) {
      const double first = static_cast<double>(begin + at) - x;
      const double last = first + static_cast<double>(kLanes - 1);
      if (first >= -half && last <= half) {
        store_wide(fractions + at, Lanes{} + 1.0f);
        continue;
      }
      const Lanes along = steps + static_cast<float>(first);
      const Lanes distance = square_root(along * along + (aside2 + 1e-12f));
      const Lanes inverse = 1.0f / distance;
      const Lanes a = (along < 0.0f ? -along : along) * inverse;
      store_wide(fractions + at, cube_behind_plane<Lanes>(a, across * inverse, up * inverse,
                                                          static_cast<float>(radius) - distance));
    }
  }
};

}  // namespace grouser
