// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "engine/lbm/solid_map.hpp"
#include "engine/lbm/streaming.hpp"

namespace grouser {

/// Faces that fluid passes: velocity, pressure and free outflow. Regularised: density or normal
/// velocity follow from what is known (Zou, He 1997), the unknown populations' share beyond
/// equilibrium is that of their opposites, and all are made anew from density, velocity and stress
/// (Latt, Chopard, Malaspinas, Deville, Michler 2008). A cell where two such faces meet belongs to
/// the first of x, y, z. Local.
template <class Set, class Real>
class OpenFaces {
 public:
  OpenFaces(const FlowSettings& settings, const CellBlocks& blocks, const SolidMap& solids,
            const CellBox& box) {
    for (int axis = 0; axis < Set::kDimensions; ++axis)
      for (int end = 0; end < 2; ++end) {
        const Face& face =
            settings.faces[static_cast<std::size_t>(axis)][static_cast<std::size_t>(end)];
        if (!is_open(face.kind)) continue;
        const std::int64_t layer =
            end == 0 ? 0 : blocks.cells()[static_cast<std::size_t>(axis)] - 1;
        faces_.push_back({face.kind, face.density_lu, axis, end, {}});
        for (std::int64_t z = 0; z < box.nz; ++z)
          for (std::int64_t y = 0; y < box.ny; ++y)
            for (std::int64_t x = 0; x < box.nx; ++x) {
              const std::int64_t at[3] = {x, y, z};
              if (at[axis] + blocks.low(axis) != layer || !solids.is_fluid(x, y, z)) continue;
              if (on_earlier(settings, blocks, at, axis)) continue;
              const Vec3 velocity =
                  face.profile ? face.profile(centre_of(blocks, x, y, z)) : face.velocity_lu;
              faces_.back().cells.push_back({x, y, z, velocity});
            }
      }
  }

  void set_velocity(int axis, int end, const Vec3& velocity) {
    for (OpenFace& face : faces_)
      for (Cell& cell : face.cells)
        if (face.axis == axis && face.end == end) cell.velocity = velocity;
  }

  /// Fills in what arrives through the faces.
  void apply(Streaming<Set, Real>& streaming, const Vec3& force) const {
    for (const OpenFace& face : faces_)
      for (const Cell& cell : face.cells) {
        if (face.kind == FaceKind::kOutflow)
          copy_inner(streaming, face, cell);
        else
          regularise(streaming, face, cell, force);
      }
  }

 private:
  struct Cell {
    std::int64_t x, y, z;
    Vec3 velocity;
  };
  struct OpenFace {
    FaceKind kind;
    double density;
    int axis;
    int end;
    std::vector<Cell> cells;

    // Component of a velocity into the fluid.
    int inward(const LatticeVelocity& c) const {
      const int along = axis == 0 ? c.x : axis == 1 ? c.y : c.z;
      return end == 0 ? along : -along;
    }
  };

  static bool is_open(FaceKind kind) {
    return kind == FaceKind::kVelocity || kind == FaceKind::kPressure || kind == FaceKind::kOutflow;
  }

  static bool on_earlier(const FlowSettings& settings, const CellBlocks& blocks,
                         const std::int64_t* at, int axis) {
    for (int a = 0; a < axis; ++a) {
      const auto index = static_cast<std::size_t>(a);
      const std::int64_t global = at[a] + blocks.low(a);
      if (global == 0 && is_open(settings.faces[index][0].kind)) return true;
      if (global + 1 == blocks.cells()[index] && is_open(settings.faces[index][1].kind))
        return true;
    }
    return false;
  }

  static void copy_inner(Streaming<Set, Real>& streaming, const OpenFace& face, const Cell& cell) {
    const int step = face.end == 0 ? 1 : -1;
    for (std::size_t i = 1; i < Set::kVelocities; ++i) {
      if (face.inward(Set::kSet.velocities[i]) != 1) continue;
      *streaming.arriving(i, cell.x, cell.y, cell.z) = *streaming.arriving(
          i, cell.x + (face.axis == 0 ? step : 0), cell.y + (face.axis == 1 ? step : 0),
          cell.z + (face.axis == 2 ? step : 0));
    }
  }

  static double projected(const LatticeVelocity& c, const Vec3& v) {
    return c.x * v.x + c.y * v.y + c.z * v.z;
  }
  static double equilibrium(std::size_t i, double density, const Vec3& u) {
    const double cu = projected(Set::kSet.velocities[i], u);
    return Set::kSet.weights[i] *
           (density - 1.0 + density * (3.0 * cu + 4.5 * cu * cu - 1.5 * norm2(u)));
  }

  static void regularise(Streaming<Set, Real>& streaming, const OpenFace& face, const Cell& cell,
                         const Vec3& force) {
    constexpr std::size_t kVelocities = Set::kVelocities;
    const auto& c = Set::kSet.velocities;
    const auto& w = Set::kSet.weights;
    std::array<double, kVelocities> f{};
    double known = 1.0;  // density of what does not come through the face, twice what leaves by it
    for (std::size_t i = 0; i < kVelocities; ++i) {
      f[i] = *streaming.arriving(i, cell.x, cell.y, cell.z);
      if (face.inward(c[i]) == 0) known += f[i];
      if (face.inward(c[i]) == -1) known += 2.0 * f[i];
    }
    const double sign = face.end == 0 ? 1.0 : -1.0;
    const auto normal = [&](const Vec3& v) {
      return sign * (face.axis == 0 ? v.x : face.axis == 1 ? v.y : v.z);
    };
    known -= 0.5 * normal(force);
    Vec3 u = cell.velocity;
    double density = face.density;
    if (face.kind == FaceKind::kVelocity) {
      density = known / (1.0 - normal(u));
    } else {
      const double speed = sign * (1.0 - known / density);
      u = {face.axis == 0 ? speed : 0.0, face.axis == 1 ? speed : 0.0,
           face.axis == 2 ? speed : 0.0};
    }
    // Stress: half of the force is not yet in what arrives.
    Symmetric<double> s;
    for (std::size_t i = 0; i < kVelocities; ++i) {
      const bool unknown = face.inward(c[i]) == 1;
      const std::size_t from = unknown ? opposite(i) : i;
      double beyond = f[from] - equilibrium(from, density, u);
      if (unknown) beyond -= 3.0 * w[i] * projected(c[i], force);
      s.xx += c[i].x * c[i].x * beyond;
      s.yy += c[i].y * c[i].y * beyond;
      s.zz += c[i].z * c[i].z * beyond;
      s.xy += c[i].x * c[i].y * beyond;
      s.xz += c[i].x * c[i].z * beyond;
      s.yz += c[i].y * c[i].z * beyond;
    }
    const double third = (s.xx + s.yy + s.zz) / 3.0;
    for (std::size_t i = 0; i < kVelocities; ++i) {
      const double x = c[i].x;
      const double y = c[i].y;
      const double z = c[i].z;
      const double stress = x * x * s.xx + y * y * s.yy + z * z * s.zz +
                            2.0 * (x * y * s.xy + x * z * s.xz + y * z * s.yz) - third;
      *streaming.arriving(i, cell.x, cell.y, cell.z) = static_cast<Real>(
          equilibrium(i, density, u) + w[i] * (4.5 * stress - 1.5 * projected(c[i], force)));
    }
  }

  std::vector<OpenFace> faces_;
};

}  // namespace grouser
