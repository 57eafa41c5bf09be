// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace grouser {
namespace {

constexpr unsigned kCorner[3] = {1u, 2u, 4u};

std::pair<Vec3, Vec3> bounds_of(const Mesh& mesh, double margin) {
  Vec3 low = mesh.vertices.at(0);
  Vec3 high = low;
  for (const Vec3& v : mesh.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  const Vec3 grow{margin, margin, margin};
  return {low - grow, high + grow};
}

// About 64 cells along the longest side keep the grid small for any mesh; finer cells than the
// reach would only repeat facets.
double cell_size(const Mesh& mesh, double reach) {
  const auto [low, high] = bounds_of(mesh, reach);
  return std::max({reach, (high.x - low.x) / 64, (high.y - low.y) / 64, (high.z - low.z) / 64});
}

}  // namespace

Triangle::Triangle(const Vec3& corner_a, const Vec3& corner_b, const Vec3& corner_c)
    : a(corner_a),
      b(corner_b),
      c(corner_c),
      ab(b - a),
      ac(c - a),
      d11(dot(ab, ab)),
      d12(dot(ab, ac)),
      d22(dot(ac, ac)),
      det(d11 * d22 - d12 * d12) {}

NearestPoint nearest_on_triangle(const Vec3& p, const Triangle& t) {
  // Barycentric coordinates of the projection; where one is negative, the nearest point is on an
  // edge facing that way.
  const Vec3 ap = p - t.a;
  const double e1 = dot(t.ab, ap);
  const double e2 = dot(t.ac, ap);
  const double beta = t.d22 * e1 - t.d12 * e2;
  const double gamma = t.d11 * e2 - t.d12 * e1;
  if (beta > 0.0 && gamma > 0.0 && beta + gamma < t.det)
    return {t.a + (beta / t.det) * t.ab + (gamma / t.det) * t.ac, 7u};

  const Vec3* const corner[3] = {&t.a, &t.b, &t.c};
  NearestPoint best;
  double best_distance = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vec3& from = *corner[k];
    const Vec3 side = *corner[next] - from;
    const double along = dot(p - from, side) / dot(side, side);
    NearestPoint here;
    if (along <= 0.0) {
      here = {from, kCorner[k]};
    } else if (along >= 1.0) {
      here = {*corner[next], kCorner[next]};
    } else {
      here = {from + along * side, kCorner[k] | kCorner[next]};
    }
    const double distance = norm2(p - here.point);
    if (k == 0 || distance < best_distance) {
      best = here;
      best_distance = distance;
    }
  }
  return best;
}

MeshSearch::MeshSearch(Mesh mesh, double reach)
    : mesh_(std::move(mesh)),
      reach_(reach),
      low_(bounds_of(mesh_, reach).first),
      high_(bounds_of(mesh_, reach).second),
      grid_(low_, high_, cell_size(mesh_, reach), 1u << 20) {
  const Vec3 half = 0.5 * (grid_.centre({1, 1, 1}) - grid_.centre({0, 0, 0}));
  const double within = reach + norm(half);
  std::vector<std::vector<int>> cells(grid_.cells());
  for (std::size_t f = 0; f < mesh_.facets.size(); ++f) {
    Mesh one{{}, {mesh_.facets[f]}};
    for (const int v : mesh_.facets[f])
      one.vertices.push_back(mesh_.vertices[static_cast<std::size_t>(v)]);
    triangles_.emplace_back(one.vertices[0], one.vertices[1], one.vertices[2]);
    const auto [low, high] = bounds_of(one, reach);
    const std::array<int, 3> from = grid_.cell_of(low);
    const std::array<int, 3> to = grid_.cell_of(high);
    for (int x = from[0]; x <= to[0]; ++x)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int z = from[2]; z <= to[2]; ++z) {
          const Vec3 centre = grid_.centre({x, y, z});
          const Vec3 nearest = nearest_on_triangle(centre, triangles_.back()).point;
          if (norm(centre - nearest) <= within)
            cells[grid_.index({x, y, z})].push_back(static_cast<int>(f));
        }
  }
  for (const Vec3& v : mesh_.vertices)
    ring_ = std::max(ring_, std::sqrt(v.x * v.x + v.z * v.z) + reach);
  start_.push_back(0);
  for (const std::vector<int>& cell : cells) {
    members_.insert(members_.end(), cell.begin(), cell.end());
    start_.push_back(static_cast<std::uint32_t>(members_.size()));
  }
}

std::pair<std::uint32_t, std::uint32_t> MeshSearch::near(const Vec3& point) const {
  if (point.x < low_.x || point.y < low_.y || point.z < low_.z || point.x > high_.x ||
      point.y > high_.y || point.z > high_.z)
    return {0, 0};
  const std::size_t cell = grid_.index(grid_.cell_of(point));
  return {start_[cell], start_[cell + 1]};
}

void MeshSearch::touches_of(const Vec3& centre, double radius,
                            std::vector<MeshTouch>& touches) const {
  const auto [begin, end] = near(centre);
  touches_of(centre, radius, members_.data() + begin, end - begin, touches);
}

void MeshSearch::touches_of(const Vec3& centre, double radius, const int* facets, std::size_t count,
                            std::vector<MeshTouch>& touches) const {
  thread_local std::vector<Candidate> candidates;
  candidates.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const NearestPoint nearest =
        nearest_on_triangle(centre, triangles_[static_cast<std::size_t>(facets[k])]);
    const double distance2 = norm2(centre - nearest.point);
    if (distance2 < radius * radius)
      candidates.push_back({{facets[k], nearest.point, std::sqrt(distance2)}, nearest.feature});
  }
  if (candidates.size() == 1) {
    touches.push_back(candidates[0].touch);
    return;
  }
  // A nearest point that also lies on a facet with a still nearer one is no local minimum; where
  // the two points agree to rounding, the touch is one and the lower facet keeps it.
  const double same = 1e-9 * radius;
  for (const Candidate& one : candidates) {
    bool is_minimum = true;
    for (const Candidate& other : candidates) {
      if (&other == &one || !is_minimum) continue;
      if (norm2(one.touch.point - other.touch.point) <= same * same) {
        is_minimum = one.touch.facet < other.touch.facet;
      } else if (lies_on(one, other.touch.facet)) {
        is_minimum = false;
      }
    }
    if (is_minimum) touches.push_back(one.touch);
  }
}

void MeshSearch::facets_within(const Vec3& point, double distance, std::vector<int>& facets) const {
  const auto [begin, end] = near(point);
  for (std::uint32_t m = begin; m < end; ++m) {
    const NearestPoint nearest =
        nearest_on_triangle(point, triangles_[static_cast<std::size_t>(members_[m])]);
    if (norm2(point - nearest.point) < distance * distance) facets.push_back(members_[m]);
  }
}

bool MeshSearch::lies_on(const Candidate& candidate, int facet) const {
  const auto& own = mesh_.facets[static_cast<std::size_t>(candidate.touch.facet)];
  const auto& other = mesh_.facets[static_cast<std::size_t>(facet)];
  for (std::size_t k = 0; k < 3; ++k)
    if ((candidate.feature & kCorner[k]) != 0 &&
        std::find(other.begin(), other.end(), own[k]) == other.end())
      return false;
  return true;
}

bool MeshSearch::may_be_near(const Vec3& point, bool turns) const {
  if (point.y < low_.y || point.y > high_.y) return false;
  if (turns) return point.x * point.x + point.z * point.z < ring_ * ring_;
  if (point.x < low_.x || point.z < low_.z || point.x > high_.x || point.z > high_.z) return false;
  const std::size_t cell = grid_.index(grid_.cell_of(point));
  return start_[cell] != start_[cell + 1];
}

bool MeshSearch::are_neighbours(int first, int second) const {
  for (const int v : mesh_.facets[static_cast<std::size_t>(first)])
    for (const int w : mesh_.facets[static_cast<std::size_t>(second)])
      if (v == w) return true;
  return false;
}

}  // namespace grouser
