// SPDX-License-Identifier: BSD-3-Clause
#include "engine/terrain/bed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/random.hpp"

namespace grouser {
namespace {

enum Stream : std::uint64_t { kSize, kPlaceX, kPlaceY, kPlaceZ };

}  // namespace

Filling::Filling(const Case& input)
    : sizes_(input.grains),
      seed_(static_cast<std::uint64_t>(input.grains.seed)),
      density_(input.grains.density) {
  const auto fit = [&](double room) {
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(room / sizes_.largest()));
  };
  along_x_ = fit(input.box.length);
  along_y_ = fit(input.box.width);
  cell_ = {input.box.length / static_cast<double>(along_x_),
           input.box.width / static_cast<double>(along_y_), sizes_.largest()};
  const double wanted =
      input.bed.solid_fraction * input.box.length * input.box.width * input.bed.depth;
  double volume = 0.0;
  while (volume < wanted) {
    const double d = diameter(count_++);
    volume += std::numbers::pi / 6.0 * d * d * d;
  }
  const std::int64_t layer = along_x_ * along_y_;
  height_ = static_cast<double>((count_ + layer - 1) / layer) * cell_.z;
}

double Filling::diameter(std::int64_t id) const {
  return sizes_.diameter_at(random_unit(seed_, static_cast<std::uint64_t>(id), kSize));
}

Particle Filling::particle(std::int64_t id) const {
  const std::int64_t layer = along_x_ * along_y_;
  const Vec3 corner{static_cast<double>(id % along_x_) * cell_.x,
                    static_cast<double>(id / along_x_ % along_y_) * cell_.y,
                    static_cast<double>(id / layer) * cell_.z};
  const double d = diameter(id);
  const auto place = [&](double room, Stream stream) {
    const double free = std::max(0.0, room - d);
    return 0.5 * d + free * random_unit(seed_, static_cast<std::uint64_t>(id), stream);
  };
  Particle p;
  p.id = id;
  p.radius = 0.5 * d;
  p.mass = density_ * std::numbers::pi / 6.0 * d * d * d;
  p.position =
      corner + Vec3{place(cell_.x, kPlaceX), place(cell_.y, kPlaceY), place(cell_.z, kPlaceZ)};
  return p;
}

double settled_energy(const Case& input) {
  const SizeCurve sizes(input.grains);
  return input.bed.settled_energy_ratio * input.grains.density * sizes.mean_volume() *
         input.gravity * sizes.mean();
}

double surface_level(const World& world, double x_low, double x_high, double y_low, double y_high) {
  const double edge = 2.0 * world.settings().largest_radius;
  const auto fit = [edge](double room) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(room / edge));
  };
  const std::size_t nx = fit(x_high - x_low);
  const std::size_t ny = fit(y_high - y_low);
  Communicator::StepTotals totals;
  totals.maxima.assign(nx * ny, -1.0);
  for (std::size_t i = 0; i < world.owned(); ++i) {
    const Particle& p = world.particles()[i];
    const double u = (p.position.x - x_low) / (x_high - x_low);
    const double v = (p.position.y - y_low) / (y_high - y_low);
    if (u < 0.0 || u >= 1.0 || v < 0.0 || v >= 1.0) continue;
    double& top = totals.maxima[static_cast<std::size_t>(u * static_cast<double>(nx)) * ny +
                                static_cast<std::size_t>(v * static_cast<double>(ny))];
    top = std::max(top, p.position.z + p.radius);
  }
  world.ranks().combine(totals);
  double sum = 0.0;
  int filled = 0;
  for (const double top : totals.maxima) {
    if (top < 0.0) continue;
    sum += top;
    ++filled;
  }
  return filled > 0 ? sum / filled : 0.0;
}

}  // namespace grouser
