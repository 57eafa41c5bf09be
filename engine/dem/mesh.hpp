// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/mesh.hpp"
#include "base/vec3.hpp"
#include "engine/core/cell_grid.hpp"

namespace grouser {

/// The point of a facet nearest to a given point, and where on the facet it lies.
struct NearestPoint {
  Vec3 point;
  /// Which vertices span the feature the point lies on: all three for the inside, two for an edge,
  /// one for a corner (bit k = vertex k of the facet).
  unsigned feature = 0;
};

/// A triangle with what finding its nearest point needs each time.
struct Triangle {
  Triangle(const Vec3& corner_a, const Vec3& corner_b, const Vec3& corner_c);

  Vec3 a, b, c;
  Vec3 ab, ac;           ///< b - a, c - a
  double d11, d12, d22;  ///< products of ab and ac with each other [m2]
  double det;            ///< d11 d22 - d12^2 [m4]
};

/// Nearest point of a triangle to p. Local.
NearestPoint nearest_on_triangle(const Vec3& p, const Triangle& triangle);

/// Where a sphere touches a mesh.
struct MeshTouch {
  int facet = 0;
  Vec3 point;             ///< nearest point of the surface, body frame [m]
  double distance = 0.0;  ///< from the centre [m]
};

/// Finds the touches of spheres with one mesh. A sphere touches where its distance to the surface
/// has a local minimum, so an edge shared by facets counts once and a flat wall of many facets acts
/// as one plane.
class MeshSearch {
 public:
  /// @param reach largest radius, plus skin, that will be asked for [m]
  MeshSearch(Mesh mesh, double reach);

  const Mesh& mesh() const { return mesh_; }

  /// Touches of a sphere, by rising facet number; appended to `touches`. Local.
  void touches_of(const Vec3& centre, double radius, std::vector<MeshTouch>& touches) const;

  /// The same when only `count` facets, in rising order, can be touched. Local.
  void touches_of(const Vec3& centre, double radius, const int* facets, std::size_t count,
                  std::vector<MeshTouch>& touches) const;

  /// Whether the surface could come within `reach` (as constructed) of a point of the body frame.
  /// @param turns the body turns about its y axis: then the ring it sweeps is tested. Local.
  bool may_be_near(const Vec3& point, bool turns) const;

  /// Appends the facets closer to a point of the body frame than `distance` (at most `reach`, as
  /// constructed) [m], in rising order. Local.
  void facets_within(const Vec3& point, double distance, std::vector<int>& facets) const;

  /// Largest distance of the surface from the body's y axis [m].
  double rim() const { return ring_ - reach_; }

  /// Whether two facets share a vertex. Local.
  bool are_neighbours(int first, int second) const;

 private:
  struct Candidate {
    MeshTouch touch;
    unsigned feature;
  };
  bool lies_on(const Candidate& candidate, int facet) const;
  // Facets near the cell of a point: begin and end in members_.
  std::pair<std::uint32_t, std::uint32_t> near(const Vec3& point) const;

  Mesh mesh_;
  std::vector<Triangle> triangles_;
  double reach_;
  Vec3 low_;
  Vec3 high_;
  double ring_ = 0.0;  // largest distance from the y axis that is within reach of the surface
  CellGrid grid_;
  std::vector<std::uint32_t> start_;  // of each cell's facets
  std::vector<int> members_;
};

}  // namespace grouser
