// SPDX-License-Identifier: BSD-3-Clause
#include "bench/wheel_bed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <string>

#include "base/errors.hpp"

namespace grouser::bench {
namespace {

constexpr int kSectors = 96;  // around the rim; 2 x 96 x (6 + 3) facets
constexpr int kStrips = 6;    // across it

using Facet = std::array<Vec3, 3>;

Vec3 at(double radius, int sector, double y) {
  const double angle = 2.0 * std::numbers::pi * (sector % kSectors) / kSectors;
  return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

std::vector<Facet> drum_facets(double radius, double width) {
  std::vector<Facet> facets;
  const double half = 0.5 * width;
  for (int s = 0; s < kSectors; ++s) {
    for (int strip = 0; strip < kStrips; ++strip) {
      const double y0 = -half + width * strip / kStrips;
      const double y1 = -half + width * (strip + 1) / kStrips;
      facets.push_back({at(radius, s, y0), at(radius, s, y1), at(radius, s + 1, y1)});
      facets.push_back({at(radius, s, y0), at(radius, s + 1, y1), at(radius, s + 1, y0)});
    }
    // Either side: a fan inside, a ring of quads outside.
    const double middle = 0.5 * radius;
    for (const double y : {-half, half}) {
      const auto add = [&](Vec3 a, Vec3 b, const Vec3& c) {
        if (y < 0.0) std::swap(a, b);
        facets.push_back({a, b, c});
      };
      add(at(middle, s + 1, y), at(middle, s, y), {0.0, y, 0.0});
      add(at(middle, s + 1, y), at(radius, s, y), at(middle, s, y));
      add(at(middle, s + 1, y), at(radius, s + 1, y), at(radius, s, y));
    }
  }
  return facets;
}

}  // namespace

void write_wheel(const std::filesystem::path& file, const Case& input) {
  std::ofstream out(file);
  out.precision(9);
  out << "solid wheel\n";
  for (const Facet& facet : drum_facets(0.5 * input.wheel.diameter, input.wheel.width)) {
    const Vec3 area = cross(facet[1] - facet[0], facet[2] - facet[0]);
    const Vec3 normal = (1.0 / norm(area)) * area;
    out << "facet normal " << normal.x << ' ' << normal.y << ' ' << normal.z << "\nouter loop\n";
    for (const Vec3& v : facet) out << "vertex " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    out << "endloop\nendfacet\n";
  }
  out << "endsolid wheel\n";
  if (!out.flush()) throw StorageError("cannot write " + file.string());
}

BodyMotion wheel_motion(const Case& input, double surface) {
  const WheelCase& wheel = input.wheel;
  BodyMotion motion;
  motion.position = {wheel.start * input.box.length, 0.5 * input.box.width,
                     surface + 0.25 * wheel.diameter};
  motion.velocity.x = wheel.forward_speed;
  motion.spin = wheel.forward_speed / ((1.0 - wheel.slip) * 0.5 * wheel.diameter);
  return motion;
}

BodyMotion read_wheel_motion(const std::filesystem::path& file) {
  std::map<std::string, double> values;
  std::ifstream in(file);
  std::string variable, name, equal;
  for (double value; in >> variable >> name >> equal >> value;) values[name] = value;
  BodyMotion motion;
  motion.position = {values.at("axle_x"), values.at("axle_y"), values.at("axle_z")};
  motion.velocity.x = values.at("wheel_speed");
  motion.spin = values.at("wheel_spin");
  return motion;
}

void remove_under_wheel(std::vector<Particle>& grains, const Case& input, const Vec3& axle) {
  std::erase_if(grains, [&](const Particle& p) {
    const Vec3 from = p.position - axle;
    const double beyond_rim = std::hypot(from.x, from.z) - 0.5 * input.wheel.diameter;
    const double beyond_side = std::abs(from.y) - 0.5 * input.wheel.width;
    return std::hypot(std::max(beyond_rim, 0.0), std::max(beyond_side, 0.0)) < p.radius;
  });
  for (std::size_t i = 0; i < grains.size(); ++i) grains[i].id = static_cast<std::int64_t>(i);
}

}  // namespace grouser::bench
