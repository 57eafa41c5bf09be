// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/communicator.hpp"

namespace grouser {

/// One quantity per point.
struct VtkField {
  std::string name;           ///< dataset name, the unit included as in "radius [m]"
  std::size_t width = 0;      ///< components per point; 0 for a scalar
  std::vector<float> values;  ///< points x width of this rank
};

/// Points with what they carry, and triangles between them. Each rank holds some of the points.
struct VtkGrid {
  std::vector<float> points;            ///< points of this rank x 3 [m]
  std::vector<std::int64_t> ids;        ///< a number per point, or empty
  std::vector<VtkField> fields;         ///< the same names and widths on every rank
  std::vector<std::int64_t> triangles;  ///< three point numbers each, counted over all ranks
  bool has_triangles = false;           ///< else every point is a cell of its own
  double time = 0.0;                    ///< simulated [s]
};

/// A box of cells with a value in each. Each rank holds whole layers of cells, those of rank 0
/// first and each rank's by rising z; within, x runs fastest, then y.
struct VtkImage {
  std::array<std::int64_t, 3> cells{};  ///< along x, y and z, over all ranks
  double spacing = 1.0;                 ///< side of a cell [m]
  std::vector<VtkField> fields;         ///< per cell
  double time = 0.0;                    ///< simulated [s]
};

/// Writes one image in VTKHDF 1.0, a point at each cell's centre, the first half a cell from the
/// origin; as
/// write_vtkhdf. Collective.
void write_vtkhdf(const Communicator& ranks, const std::filesystem::path& file,
                  const VtkImage& image);

/// Writes one unstructured grid in VTKHDF 1.0 (VTK file formats, "VTKHDF"), which ParaView 5.10 and
/// later open. The file appears under its name only when it is complete.
/// @throws StorageError on every rank when it could not be written. Collective.
void write_vtkhdf(const Communicator& ranks, const std::filesystem::path& file,
                  const VtkGrid& grid);

}  // namespace grouser
