// SPDX-License-Identifier: BSD-3-Clause
#include "engine/terrain/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grouser {
namespace {

Vec3 on_circle(double radius, double angle) {
  return {radius * std::sin(angle), 0.0, -radius * std::cos(angle)};
}

std::vector<Vec3> grouser_outline(const WheelCase& wheel) {
  const double tip = 0.5 * wheel.diameter;
  const double base = tip - wheel.grouser_height;
  const double pitch = 2.0 * std::numbers::pi / static_cast<double>(wheel.grousers);
  const double half_tip = 0.5 * wheel.grouser_width / tip;
  const double half_base = 0.5 * wheel.grouser_width / base;
  const auto gap_facets = std::max<std::int64_t>(1, wheel.facets / wheel.grousers);
  std::vector<Vec3> outline;
  for (std::int64_t g = 0; g < wheel.grousers; ++g) {
    const double middle = pitch * static_cast<double>(g);
    outline.push_back(on_circle(base, middle - half_base));
    outline.push_back(on_circle(tip, middle - half_tip));
    outline.push_back(on_circle(tip, middle + half_tip));
    outline.push_back(on_circle(base, middle + half_base));
    const double gap = pitch - 2.0 * half_base;
    for (std::int64_t f = 1; f < gap_facets; ++f)
      outline.push_back(on_circle(
          base,
          middle + half_base + gap * static_cast<double>(f) / static_cast<double>(gap_facets)));
  }
  return outline;
}

}  // namespace

Mesh box_mesh(double length, double width, double height) {
  Mesh mesh;
  for (const double z : {0.0, height})
    for (const double y : {0.0, width})
      for (const double x : {0.0, length}) mesh.vertices.push_back({x, y, z});
  mesh.facets = {{0, 1, 3}, {0, 3, 2},   // floor
                 {0, 4, 5}, {0, 5, 1},   // y = 0
                 {2, 3, 7}, {2, 7, 6},   // y = width
                 {0, 2, 6}, {0, 6, 4},   // x = 0
                 {1, 5, 7}, {1, 7, 3}};  // x = length
  return mesh;
}

std::vector<Vec3> wheel_outline(const WheelCase& wheel) {
  if (wheel.profile == "stl") return {};
  if (wheel.profile == "grousers") return grouser_outline(wheel);
  std::vector<Vec3> outline;
  for (std::int64_t f = 0; f < wheel.facets; ++f)
    outline.push_back(on_circle(
        0.5 * wheel.diameter,
        2.0 * std::numbers::pi * static_cast<double>(f) / static_cast<double>(wheel.facets)));
  return outline;
}

Mesh wheel_mesh(const WheelCase& wheel) {
  if (wheel.profile == "stl") return read_stl(wheel.stl_file, wheel.stl_scale);
  const std::vector<Vec3> outline = wheel_outline(wheel);
  const int count = static_cast<int>(outline.size());
  const double half = 0.5 * wheel.width;
  Mesh mesh;
  for (const double y : {-half, half})
    for (const Vec3& v : outline) mesh.vertices.push_back({v.x, y, v.z});
  mesh.vertices.push_back({0.0, -half, 0.0});
  mesh.vertices.push_back({0.0, half, 0.0});
  for (int f = 0; f < count; ++f) {
    const int next = (f + 1) % count;
    mesh.facets.push_back({f, next, count + next});
    mesh.facets.push_back({f, count + next, count + f});
    mesh.facets.push_back({2 * count, next, f});
    mesh.facets.push_back({2 * count + 1, count + f, count + next});
  }
  return mesh;
}

}  // namespace grouser
