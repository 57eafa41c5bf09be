// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>

#include "engine/lbm/cell_blocks.hpp"
#include "engine/lbm/populations.hpp"

namespace grouser {

/// What a volume-averaged flow and the grains in it tell each other: numbers of every cell of a
/// rank's block, in lattice units. Cells are named within the block.
///
/// The flow solves, with the void fraction n, the fluid's velocity u between grains, and
/// p = (density - 1)/3,
///
///     dp/dt 3 + div(n u) = source           source = -dn/dt, so that what grains leave, fluid
///     fills d(n u)/dt + div(n u u) = -grad p + viscosity x lap(n u) + push - drag x u
///
/// which is model B of the exchange of momentum; with a pressure force on grains, and its opposite
/// in the push, it is model A. Momentum of a cell is n u, that of its populations. The equilibrium
/// is that of Guo and Zhao 2002 with the void fraction of the cell; drag is solved for within the
/// step, so that no drag is too strong. Fluid at rest stays at rest whatever n. Neglected: change
/// of the viscous stress by the void fraction beyond Brinkman's form; all of the order of the Mach
/// number squared.
class AveragedFields {
 public:
  enum Field : std::size_t {
    kVoid,    ///< void fraction, 1 at first [1]; read
    kSource,  ///< volume of fluid that comes into being in a step; read
    kPushX,   ///< force density on the fluid that does not depend on its velocity; read
    kPushY,
    kPushZ,
    kDrag,       ///< force density over the fluid's velocity, against it; read
    kVelocityX,  ///< of the fluid between the grains, in the middle of the step; written
    kVelocityY,
    kVelocityZ,
    kPressure,   ///< beyond that at rest; written
    kGradientX,  ///< of the pressure; by differentiate()
    kGradientY,
    kGradientZ,
    kFields
  };

  explicit AveragedFields(const CellBox& box);

  double& at(Field field, std::int64_t x, std::int64_t y, std::int64_t z) {
    return values_.of(field)[values_.at(x, y, z)];
  }
  double at(Field field, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return values_.of(field)[values_.at(x, y, z)];
  }
  double* of(Field field) { return values_.of(field); }
  /// Sets a field to `value` everywhere. Local.
  void fill(Field field, double value);
  std::size_t bytes() const { return values_.bytes(); }

  /// Gradient of the pressure in every cell of the block, by central differences, which do not see
  /// what changes its sign from cell to cell; to one side at ends that are not periodic. The
  /// pressure of the layer around must be there. Local.
  void differentiate(const CellBlocks& blocks);

  /// Brings fields of the neighbours' cells along y and z to the layer around the block; beyond
  /// ends that are not periodic it stays as it is. Collective.
  void exchange(const Communicator& ranks, const CellBlocks& blocks,
                std::initializer_list<Field> fields);

 private:
  void exchange_axis(const Communicator& ranks, const CellBlocks& blocks, int axis,
                     std::initializer_list<Field> fields);
  void copy(int axis, std::int64_t layer, std::initializer_list<Field> fields, double* message,
            bool pack);

  Populations<double> values_;
};

}  // namespace grouser
