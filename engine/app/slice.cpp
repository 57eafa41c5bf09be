// SPDX-License-Identifier: BSD-3-Clause
#include "engine/app/slice.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "engine/app/setup.hpp"
#include "engine/terrain/shapes.hpp"

namespace grouser {
namespace {

struct SliceGrain {
  std::int64_t id;
  double x, z, radius, displacement;
};

std::string row(const std::string& kind, double x, double z) {
  return kind + "," + format_number(x) + "," + format_number(z);
}

}  // namespace

std::string slice_text(const World& world, const Case& input) {
  const double middle = 0.5 * input.box.width;
  const double half =
      input.has_wheel ? 0.25 * input.wheel.width : 2.0 * world.settings().largest_radius;
  std::vector<Bytes> out(static_cast<std::size_t>(world.ranks().size()));
  for (std::size_t i = 0; i < world.owned(); ++i) {
    const Particle& p = world.particles()[i];
    if (std::abs(p.position.y - middle) > half) continue;
    const SliceGrain grain{p.id, p.position.x, p.position.z, p.radius,
                           norm(p.position - world.origins()[i])};
    append_bytes(out[0], &grain, 1);
  }
  std::vector<SliceGrain> grains;
  for (const Bytes& message : world.ranks().exchange_all(out)) {
    ByteReader reader(message);
    while (!reader.empty()) reader.take(&grains.emplace_back(), 1);
  }
  if (world.ranks().rank() != 0) return "";
  std::sort(grains.begin(), grains.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  std::string text = "kind,x [m],z [m],radius [m],displacement [m]\n";
  text += row("box", input.box.length, input.box.depth) + ",,\n";
  for (const SliceGrain& g : grains)
    text += row("grain", g.x, g.z) + "," + format_number(g.radius) + "," +
            format_number(g.displacement) + "\n";
  if (input.has_wheel) {
    const BodyFrame frame(world.body(kWheelBody).motion);
    for (const Vec3& v : wheel_outline(input.wheel)) {
      const Vec3 at = frame.to_world(v);
      text += row("wheel", at.x, at.z) + ",,\n";
    }
  }
  return text;
}

}  // namespace grouser
