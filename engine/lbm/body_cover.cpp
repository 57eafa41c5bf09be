// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/body_cover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grouser {
namespace {

// Place of line number `line` of a row of lines that begins at cell `first`.
double place_of(std::int64_t first, std::int64_t line) {
  return static_cast<double>(first) - 0.5 + (static_cast<double>(line) + 0.5) / BodyCover::kLines;
}
// The first line not below `at`.
std::int64_t line_from(std::int64_t first, double at) {
  return static_cast<std::int64_t>(
      std::ceil((at - static_cast<double>(first) + 0.5) * BodyCover::kLines - 0.5));
}

// Twice the area of the triangle that a line along x makes with an edge, seen along x. The same
// number for both facets of an edge, so that a line passes one of them.
double side_of(const std::vector<Vec3>& corners, int from, int to, double y, double z) {
  const Vec3& a = corners[static_cast<std::size_t>(std::min(from, to))];
  const Vec3& b = corners[static_cast<std::size_t>(std::max(from, to))];
  return (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
}

}  // namespace

BodyCover::BodyCover(const std::vector<Vec3>& corners,
                     const std::vector<std::array<int, 3>>& facets, const Rows& rows)
    : rows_(rows) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low{0.0, kFar, kFar};
  Vec3 high{0.0, -kFar, -kFar};
  for (const Vec3& c : corners) {
    low = {0.0, std::min(low.y, c.y), std::min(low.z, c.z)};
    high = {0.0, std::max(high.y, c.y), std::max(high.z, c.z)};
  }
  const auto cell = [](double at) { return static_cast<std::int64_t>(std::floor(at + 0.5)); };
  rows_.y_begin = std::clamp(cell(low.y), rows.y_begin, rows.y_end);
  rows_.z_begin = std::clamp(cell(low.z), rows.z_begin, rows.z_end);
  rows_.y_end = std::clamp(cell(high.y) + 1, rows_.y_begin, rows.y_end);
  rows_.z_end = std::clamp(cell(high.z) + 1, rows_.z_begin, rows.z_end);
  for (const auto& facet : facets) cross(corners, facet);
  std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
    return a.line != b.line ? a.line < b.line : a.x < b.x;
  });
  const std::int64_t lines = line_of(0, kLines * (rows_.z_end - rows_.z_begin));
  starts_.assign(static_cast<std::size_t>(lines) + 1, 0);
  for (const Crossing& c : crossings_) ++starts_[static_cast<std::size_t>(c.line) + 1];
  for (std::size_t line = 1; line < starts_.size(); ++line) starts_[line] += starts_[line - 1];
}

// Lines that pass a facet, and where.
void BodyCover::cross(const std::vector<Vec3>& corners, const std::array<int, 3>& facet) {
  const Vec3& a = corners[static_cast<std::size_t>(facet[0])];
  const Vec3& b = corners[static_cast<std::size_t>(facet[1])];
  const Vec3& c = corners[static_cast<std::size_t>(facet[2])];
  const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
  const auto [low_z, high_z] = std::minmax({a.z, b.z, c.z});
  const std::int64_t last_y =
      std::min(line_from(rows_.y_begin, high_y), kLines * (rows_.y_end - rows_.y_begin) - 1);
  const std::int64_t last_z =
      std::min(line_from(rows_.z_begin, high_z), kLines * (rows_.z_end - rows_.z_begin) - 1);
  for (std::int64_t up = std::max<std::int64_t>(0, line_from(rows_.z_begin, low_z)); up <= last_z;
       ++up)
    for (std::int64_t across = std::max<std::int64_t>(0, line_from(rows_.y_begin, low_y));
         across <= last_y; ++across) {
      const double y = place_of(rows_.y_begin, across);
      const double z = place_of(rows_.z_begin, up);
      double side[3];
      bool left[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const int from = facet[k];
        const int to = facet[(k + 1) % 3];
        side[k] = side_of(corners, from, to, y, z);
        left[k] = (side[k] >= 0.0) == (from < to);
        if (from > to) side[k] = -side[k];
      }
      if (left[0] != left[1] || left[1] != left[2]) continue;
      const double sum = side[0] + side[1] + side[2];
      crossings_.push_back(
          {line_of(across, up), (side[1] * a.x + side[2] * b.x + side[0] * c.x) / sum});
    }
}

// The covered parts of the lines through a row.
template <class Visit>
void BodyCover::each_part(std::int64_t y, std::int64_t z, const Visit& visit) const {
  if (y < rows_.y_begin || y >= rows_.y_end || z < rows_.z_begin || z >= rows_.z_end) return;
  for (std::int64_t up = 0; up < kLines; ++up)
    for (std::int64_t across = 0; across < kLines; ++across) {
      const auto line = static_cast<std::size_t>(
          line_of((y - rows_.y_begin) * kLines + across, (z - rows_.z_begin) * kLines + up));
      for (std::uint32_t c = starts_[line]; c + 1 < starts_[line + 1]; c += 2)
        visit(crossings_[c].x, crossings_[c + 1].x);
    }
}

std::pair<std::int64_t, std::int64_t> BodyCover::reach(std::int64_t y, std::int64_t z) const {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  each_part(y, z, [&](double from, double to) {
    low = std::min(low, from);
    high = std::max(high, to);
  });
  if (high <= low) return {0, 0};
  return {static_cast<std::int64_t>(std::floor(low + 0.5)),
          static_cast<std::int64_t>(std::floor(high + 0.5)) + 1};
}

void BodyCover::cover(std::int64_t y, std::int64_t z, std::int64_t begin, std::int64_t count,
                      float* fractions) const {
  std::fill(fractions, fractions + count, 0.0f);
  constexpr float kShare = 1.0f / (kLines * kLines);
  each_part(y, z, [&](double from, double to) {
    const double low = from + 0.5 - static_cast<double>(begin);
    const double high = to + 0.5 - static_cast<double>(begin);
    const auto first = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(low)));
    const auto last =
        std::min<std::int64_t>(count - 1, static_cast<std::int64_t>(std::floor(high)));
    for (std::int64_t k = first; k <= last; ++k) {
      const auto at = static_cast<double>(k);
      fractions[k] += kShare * static_cast<float>(std::min(high, at + 1.0) - std::max(low, at));
    }
  });
}

}  // namespace grouser
