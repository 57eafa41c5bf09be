// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/check.hpp"
#include "engine/lbm/wall_links.hpp"

namespace grouser {

template <class Set, class Real>
WallLinks<Set, Real>::WallLinks(const FlowSettings& settings, const CellBlocks& blocks,
                                const SolidMap& solids, const CellBox& box)
    : blocks_(blocks) {
  for (const Obstacle& o : settings.obstacles)
    surfaces_.push_back({o.velocity_lu, o.spin_lu, o.centre});
  for (const auto& ends : settings.faces)
    for (const Face& face : ends)
      surfaces_.push_back({face.kind == FaceKind::kWall ? face.velocity_lu : Vec3{}, {}, {}});
  const auto on_face = [&](const Cell& c) {
    const std::int64_t at[3] = {c.x, c.y, c.z};
    for (int a = 0; a < Set::kDimensions; ++a)
      if (!blocks.periodic(a) &&
          (at[a] + blocks.low(a) == 0 ||
           at[a] + blocks.low(a) + 1 == blocks.cells()[static_cast<std::size_t>(a)]))
        return true;
    return false;
  };
  for (std::int32_t z = 0; z < box.nz; ++z)
    for (std::int32_t y = 0; y < box.ny; ++y)
      for (std::int32_t x = 0; x < box.nx; ++x)
        if (solids.is_fluid(x, y, z) && (solids.has_obstacles() || on_face({x, y, z})))
          link_cell(settings, solids, {x, y, z});
  links_.shrink_to_fit();
  mirrors_.shrink_to_fit();
}

template <class Set, class Real>
void WallLinks<Set, Real>::link_cell(const FlowSettings& settings, const SolidMap& solids,
                                     const Cell& cell) {
  for (std::size_t i = 1; i < Set::kVelocities; ++i) {
    const LatticeVelocity c = Set::kSet.velocities[i];
    const std::int16_t source = solids.at(cell.x - c.x, cell.y - c.y, cell.z - c.z);
    if (source == SolidMap::kFluid) continue;
    Link link{cell, static_cast<std::uint8_t>(i), false, 0, 0.5};
    if (source >= 0) {
      link.surface = static_cast<std::uint16_t>(source);
      const Obstacle& obstacle = settings.obstacles[static_cast<std::size_t>(source)];
      if (obstacle.interpolated) cut(obstacle, solids, link);
      links_.push_back(link);
      continue;
    }
    const std::int64_t from[3] = {cell.x - c.x, cell.y - c.y, cell.z - c.z};
    bool slips = false;
    bool sticks = false;
    for (int a = 0; a < Set::kDimensions && !sticks; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const std::int64_t global = from[a] + blocks_.low(a);
      if (blocks_.periodic(a) || (global >= 0 && global < blocks_.cells()[axis])) continue;
      const std::size_t end = global < 0 ? 0 : 1;
      const FaceKind kind = settings.faces[axis][end].kind;
      sticks = kind == FaceKind::kWall;
      slips = slips || kind == FaceKind::kSlip;
      link.surface = static_cast<std::uint16_t>(settings.obstacles.size() + 2 * axis + end);
    }
    if (const auto mirror = mirror_of(settings, solids, cell, i); !sticks && slips && mirror)
      mirrors_.push_back(*mirror);
    else if (sticks || slips)
      links_.push_back(link);
  }
}

// Flips those components that a slip face is beyond of.
template <class Set, class Real>
auto WallLinks<Set, Real>::mirror_of(const FlowSettings& settings, const SolidMap& solids,
                                     const Cell& cell, std::size_t i) const
    -> std::optional<Mirror> {
  const LatticeVelocity c = Set::kSet.velocities[i];
  std::array<int, 3> mirrored = {c.x, c.y, c.z};
  std::array<std::int64_t, 3> from = {cell.x - c.x, cell.y - c.y, cell.z - c.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const std::int64_t global = from[a] + blocks_.low(axis);
    if (blocks_.periodic(axis) || (global >= 0 && global < blocks_.cells()[a])) continue;
    if (settings.faces[a][global < 0 ? 0 : 1].kind != FaceKind::kSlip) continue;
    from[a] += mirrored[a];
    mirrored[a] = -mirrored[a];
  }
  if (!solids.is_fluid(from[0], from[1], from[2])) return std::nullopt;
  for (std::size_t j = 1; j < Set::kVelocities; ++j) {
    const LatticeVelocity d = Set::kSet.velocities[j];
    if (d.x == mirrored[0] && d.y == mirrored[1] && d.z == mirrored[2])
      return Mirror{cell,
                    {static_cast<std::int32_t>(from[0]), static_cast<std::int32_t>(from[1]),
                     static_cast<std::int32_t>(from[2])},
                    static_cast<std::uint8_t>(i),
                    static_cast<std::uint8_t>(j)};
  }
  return std::nullopt;
}

// Where on the link from the cell into the obstacle the surface is, by bisection.
template <class Set, class Real>
void WallLinks<Set, Real>::cut(const Obstacle& obstacle, const SolidMap& solids, Link& link) const {
  const LatticeVelocity c = Set::kSet.velocities[link.velocity];
  if (!solids.is_fluid(link.cell.x + c.x, link.cell.y + c.y, link.cell.z + c.z)) return;
  const Vec3 centre = centre_of(blocks_, link.cell.x, link.cell.y, link.cell.z);
  const Vec3 inward{static_cast<double>(-c.x), static_cast<double>(-c.y),
                    static_cast<double>(-c.z)};
  double outside = 0.0;
  double inside = 1.0;
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = 0.5 * (outside + inside);
    (obstacle.distance(centre + middle * inward) < 0.0 ? inside : outside) = middle;
  }
  link.share = inside;
  link.interpolated = true;
}

template <class Set, class Real>
void WallLinks<Set, Real>::set_face_velocity(int axis, int end, const Vec3& velocity) {
  surfaces_[surfaces_.size() - 6 + static_cast<std::size_t>(2 * axis + end)].velocity = velocity;
}

template <class Set, class Real>
Vec3 WallLinks<Set, Real>::meeting(const Link& link) const {
  const LatticeVelocity c = Set::kSet.velocities[link.velocity];
  const Vec3 back{static_cast<double>(-c.x), static_cast<double>(-c.y), static_cast<double>(-c.z)};
  return centre_of(blocks_, link.cell.x, link.cell.y, link.cell.z) + link.share * back;
}

template <class Set, class Real>
double WallLinks<Set, Real>::push(const Link& link) const {
  const Surface& surface = surfaces_[link.surface];
  Vec3 velocity = surface.velocity;
  if (norm2(surface.spin) > 0.0) velocity += cross(surface.spin, meeting(link) - surface.centre);
  const LatticeVelocity c = Set::kSet.velocities[link.velocity];
  return 6.0 * Set::kSet.weights[link.velocity] *
         (c.x * velocity.x + c.y * velocity.y + c.z * velocity.z);
}

template <class Set, class Real>
void WallLinks<Set, Real>::apply(Streaming<Set, Real>& streaming) const {
  // What links read was sent by cells of fluid and is no place of another link: any order will do.
  for (const Link& link : links_) {
    const Cell& at = link.cell;
    const std::size_t i = link.velocity;
    const Real back = *streaming.sent(opposite(i), at.x, at.y, at.z);
    const auto moved = static_cast<Real>(push(link));
    Real value = back + moved;
    if (link.interpolated) {
      const auto twice = static_cast<Real>(2.0 * link.share);
      const LatticeVelocity c = Set::kSet.velocities[i];
      if (link.share < 0.5)
        value =
            twice * back +
            (Real(1) - twice) * *streaming.sent(opposite(i), at.x + c.x, at.y + c.y, at.z + c.z) +
            moved;
      else
        value = (back + (twice - Real(1)) * *streaming.sent(i, at.x, at.y, at.z) + moved) / twice;
    }
    *streaming.arriving(i, at.x, at.y, at.z) = value;
  }
  for (const Mirror& mirror : mirrors_) {
    const Cell& at = mirror.cell;
    *streaming.arriving(mirror.velocity, at.x, at.y, at.z) =
        *streaming.sent(mirror.sent, mirror.from.x, mirror.from.y, mirror.from.z);
  }
}

template <class Set, class Real>
auto WallLinks<Set, Real>::loads(const Streaming<Set, Real>& streaming) const -> std::vector<Sums> {
  std::vector<Sums> loads(surfaces_.size());
  for (const Link& link : links_) {
    const Cell& at = link.cell;
    const LatticeVelocity c = Set::kSet.velocities[link.velocity];
    const double gone = *streaming.sent(opposite(link.velocity), at.x, at.y, at.z);
    const double came = *streaming.arriving(link.velocity, at.x, at.y, at.z);
    const Surface& surface = surfaces_[link.surface];
    const Vec3 point = meeting(link);
    const Vec3 velocity = surface.velocity + cross(surface.spin, point - surface.centre);
    const Vec3 along{static_cast<double>(c.x), static_cast<double>(c.y), static_cast<double>(c.z)};
    const Vec3 force = gone * (-along - velocity) - came * (along - velocity);
    const Vec3 moment = cross(point - surface.centre, force);
    Sums& sums = loads[link.surface];
    const double f[3] = {force.x, force.y, force.z};
    const double m[3] = {moment.x, moment.y, moment.z};
    for (std::size_t a = 0; a < 3; ++a) {
      sums.force[a].add(f[a]);
      sums.moment[a].add(m[a]);
    }
  }
  return loads;
}

template <class Set, class Real>
std::size_t WallLinks<Set, Real>::bytes() const {
  return links_.capacity() * sizeof(Link) + mirrors_.capacity() * sizeof(Mirror);
}

}  // namespace grouser
