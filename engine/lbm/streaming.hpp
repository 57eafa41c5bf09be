// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "engine/lbm/cell_blocks.hpp"
#include "engine/lbm/sweep.hpp"

namespace grouser {

/// Populations and the step that is due: tells where in memory what arrives at a cell lies, and
/// what it sent. Cells are named within the rank's box; x may be beyond the ends of a periodic row.
template <class Set, class Real>
class Streaming {
 public:
  Streaming(const CellBox& box, bool periodic_x)
      : populations_(box, Set::kVelocities), period_x_(periodic_x ? box.nx : 0) {}

  Populations<Real>& populations() { return populations_; }
  const Populations<Real>& populations() const { return populations_; }
  Parity parity() const { return parity_; }
  void set_parity(Parity parity) { parity_ = parity; }
  std::ptrdiff_t period_x() const { return period_x_; }

  /// What arrives along velocity i in the step that is due.
  Real* arriving(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) {
    return populations_.of(0) + arriving_at(i, x, y, z);
  }
  const Real* arriving(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return populations_.of(0) + arriving_at(i, x, y, z);
  }
  /// What the cell sent along velocity i in the step before; gone once its receiver's place has
  /// been written to.
  const Real* sent(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const {
    if (parity_ == Parity::kOdd) return place(opposite(i), wrapped(x), y, z);
    // Beyond the end of a periodic row it has been moved to the cell it is for.
    const LatticeVelocity c = Set::kSet.velocities[i];
    return place(i, wrapped(wrapped(x) + c.x), y + c.y, z + c.z);
  }

  /// Place of `arriving` relative to the first population.
  std::ptrdiff_t arriving_at(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const {
    if (parity_ == Parity::kEven) return offset(i, wrapped(x), y, z);
    const LatticeVelocity c = Set::kSet.velocities[i];
    return offset(opposite(i), wrapped(wrapped(x) - c.x), y - c.y, z - c.z);
  }

 private:
  std::int64_t wrapped(std::int64_t x) const {
    if (period_x_ == 0) return x;
    return x < 0 ? x + period_x_ : x >= period_x_ ? x - period_x_ : x;
  }
  std::ptrdiff_t offset(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::ptrdiff_t>(i) * populations_.step_velocity() + populations_.at(x, y, z);
  }
  const Real* place(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return populations_.of(0) + offset(i, x, y, z);
  }

  Populations<Real> populations_;
  std::ptrdiff_t period_x_;
  Parity parity_ = Parity::kEven;
};

}  // namespace grouser
