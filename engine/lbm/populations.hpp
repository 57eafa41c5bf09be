// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "engine/lbm/wide.hpp"

namespace grouser {

/// A box of cells of one rank, with a layer of ghosts around it: x -1 ... nx, and so on. Flat
/// lattices have no layer in z.
struct CellBox {
  std::int64_t nx = 1;
  std::int64_t ny = 1;
  std::int64_t nz = 1;
  std::int64_t ghosts_z = 1;  ///< 0 or 1

  std::int64_t cells() const { return nx * ny * nz; }
};

/// The populations of a box of cells in one array per velocity: x runs fastest, then y, then z, so
/// that a register holds one population of neighbouring cells. Each row starts on a cache line and
/// has a line to spare behind it, in which the ghosts of its end and of the next row's beginning
/// lie. Arrays are set apart by an odd number of lines, or all of them would compete for the same
/// places of the caches. All zero when made: fluid at rest.
template <class Real>
class Populations {
 public:
  Populations(const CellBox& box, std::size_t velocities);

  const CellBox& box() const { return box_; }
  /// Distance of neighbours in memory.
  std::ptrdiff_t step_y() const { return pitch_; }
  std::ptrdiff_t step_z() const { return pitch_ * (box_.ny + 2); }
  std::ptrdiff_t step_velocity() const { return step_velocity_; }
  /// Place of a cell in each velocity's array, relative to cell (0, 0, 0).
  std::ptrdiff_t at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return z * step_z() + y * step_y() + x;
  }
  /// Population of velocity i of cell (0, 0, 0).
  Real* of(std::size_t i) { return first_ + static_cast<std::ptrdiff_t>(i) * step_velocity_; }
  const Real* of(std::size_t i) const {
    return first_ + static_cast<std::ptrdiff_t>(i) * step_velocity_;
  }
  /// All memory it has [byte].
  std::size_t bytes() const { return bytes_; }

 private:
  struct Release {
    std::size_t bytes;
    void operator()(void* at) const;
  };

  CellBox box_;
  std::ptrdiff_t pitch_ = 0;
  std::ptrdiff_t step_velocity_ = 0;
  std::size_t bytes_ = 0;
  std::unique_ptr<void, Release> memory_;
  Real* first_ = nullptr;
};

}  // namespace grouser
