// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/averaged.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace grouser {

AveragedFields::AveragedFields(const CellBox& box) : values_(box, kFields) { fill(kVoid, 1.0); }

void AveragedFields::fill(Field field, double value) {
  const CellBox& box = values_.box();
  // All of it, what lies between rows too: registers reach there.
  double* const first = values_.of(field) + values_.at(-1, -1, -box.ghosts_z);
  std::fill(first, first + values_.step_z() * (box.nz + 2 * box.ghosts_z), value);
}

void AveragedFields::differentiate(const CellBlocks& blocks) {
  const CellBox& box = values_.box();
  const std::int64_t n[3] = {box.nx, box.ny, box.nz};
  for (int axis = 0; axis < 3; ++axis) {
    const auto to = static_cast<Field>(kGradientX + axis);
    const std::int64_t all = blocks.cells()[static_cast<std::size_t>(axis)];
    for (std::int64_t z = 0; z < box.nz; ++z)
      for (std::int64_t y = 0; y < box.ny; ++y)
        for (std::int64_t x = 0; x < box.nx; ++x) {
          const auto pressure = [&](std::int64_t step) {
            std::int64_t at[3] = {x, y, z};
            at[axis] += step;
            if (axis == 0) at[0] = (at[0] + n[0]) % n[0];  // rows are whole
            return this->at(kPressure, at[0], at[1], at[2]);
          };
          const std::int64_t global = (axis == 0 ? x : axis == 1 ? y : z) + blocks.low(axis);
          const std::int64_t low = global > 0 || blocks.periodic(axis) ? -1 : 0;
          const std::int64_t high = global + 1 < all || blocks.periodic(axis) ? 1 : 0;
          this->at(to, x, y, z) =
              high == low ? 0.0
                          : (pressure(high) - pressure(low)) / static_cast<double>(high - low);
        }
  }
}

void AveragedFields::exchange(const Communicator& ranks, const CellBlocks& blocks,
                              std::initializer_list<Field> fields) {
  exchange_axis(ranks, blocks, 1, fields);
  exchange_axis(ranks, blocks, 2, fields);
}

// The layer goes with the ghosts that it has of the axes before, so that edges follow.
void AveragedFields::exchange_axis(const Communicator& ranks, const CellBlocks& blocks, int axis,
                                   std::initializer_list<Field> fields) {
  const CellBox& box = values_.box();
  const std::int64_t rows = axis == 1 ? box.nz : box.ny + 2;
  const std::size_t size = fields.size() * static_cast<std::size_t>(rows * box.nx);
  const std::int64_t last = blocks.count(axis) - 1;
  std::array<std::vector<double>, 2> out;
  std::array<std::vector<double>, 2> in;
  Messages messages(ranks);
  for (const int direction : {1, -1}) {
    const std::size_t k = direction > 0 ? 0 : 1;
    const int to = blocks.neighbour(axis, direction);
    const int from = blocks.neighbour(axis, -direction);
    out[k].resize(size);
    in[k].resize(size);
    if (to >= 0) copy(axis, direction > 0 ? last : 0, fields, out[k].data(), true);
    if (from >= 0 && from != ranks.rank())
      messages.receive(from, in[k].data(), size * sizeof(double));
  }
  for (const int direction : {1, -1}) {
    const std::size_t k = direction > 0 ? 0 : 1;
    const int to = blocks.neighbour(axis, direction);
    if (to == ranks.rank()) in[k] = out[k];
    if (to >= 0 && to != ranks.rank()) messages.send(to, out[k].data(), size * sizeof(double));
  }
  messages.finish();
  for (const int direction : {1, -1})
    if (blocks.neighbour(axis, -direction) >= 0)
      copy(axis, direction > 0 ? -1 : last + 1, fields, in[direction > 0 ? 0 : 1].data(), false);
}

void AveragedFields::copy(int axis, std::int64_t layer, std::initializer_list<Field> fields,
                          double* message, bool pack) {
  const CellBox& box = values_.box();
  const std::int64_t rows = axis == 1 ? box.nz : box.ny + 2;
  for (const Field field : fields)
    for (std::int64_t row = 0; row < rows; ++row, message += box.nx) {
      double* const cells = values_.of(field) +
                            (axis == 1 ? values_.at(0, layer, row) : values_.at(0, row - 1, layer));
      if (pack)
        std::copy(cells, cells + box.nx, message);
      else
        std::copy(message, message + box.nx, cells);
    }
}

}  // namespace grouser
