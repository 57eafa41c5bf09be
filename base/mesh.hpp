// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/vec3.hpp"

namespace grouser {

/// A surface of triangles with shared vertices, in the frame of its body.
struct Mesh {
  std::vector<Vec3> vertices;              ///< [m]
  std::vector<std::array<int, 3>> facets;  ///< vertex numbers

  /// @throws ConfigError when a facet has no area, names a vertex that is not there or the mesh is
  /// empty; `name` says whose mesh it is. Local.
  void check(const std::string& name) const;

  /// @throws ConfigError as check, and when the surface is not closed: every edge must belong to
  /// two facets that pass it in opposite directions, or a grain at a gap would touch twice. Local.
  void check_closed(const std::string& name) const;
};

/// Reads an STL surface, text or binary; vertices at the same place become one.
/// @param scale length of one unit of the file [m]
/// @throws ConfigError when the file cannot be read or holds no usable surface. Local.
Mesh read_stl(const std::filesystem::path& file, double scale);

}  // namespace grouser
