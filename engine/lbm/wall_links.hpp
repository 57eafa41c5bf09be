// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "engine/core/exact_sum.hpp"
#include "engine/lbm/solid_map.hpp"
#include "engine/lbm/streaming.hpp"

namespace grouser {

/// All links between cells that a wall cuts: what arrives along them is what the cell, or one
/// beside it, sent in the step before.
///   half-way       f(i) = s(-i) + 6 w c.uw                              (Ladd 1994)
///   interpolated   f(i) = 2 q s(-i) + (1 - 2 q) s'(-i) + 6 w c.uw        q < 1/2
///                  f(i) = [s(-i) + (2 q - 1) s(i) + 6 w c.uw] / (2 q)    q >= 1/2
///   slip           f(i) = s'(i mirrored at the wall)                    s' beside the cell
/// s is what the cell itself sent, s' what its neighbour sent, q the distance of the wall from the
/// cell in parts of the link, uw the wall's velocity. Source of the interpolated form: Bouzidi,
/// Firdaouss, Lallemand 2001. Where the neighbour it needs is no fluid, the half-way form is used.
template <class Set, class Real>
class WallLinks {
 public:
  /// Surfaces are numbered: obstacles, then the six faces.
  WallLinks(const FlowSettings& settings, const CellBlocks& blocks, const SolidMap& solids,
            const CellBox& box);

  void set_face_velocity(int axis, int end, const Vec3& velocity);

  /// Fills in what arrives from walls. Local.
  void apply(Streaming<Set, Real>& streaming) const;

  /// Momentum given to every surface in the last step. Local sums.
  struct Sums {
    std::array<ExactSum, 3> force;
    std::array<ExactSum, 3> moment;
  };
  std::vector<Sums> loads(const Streaming<Set, Real>& streaming) const;

  std::size_t surfaces() const { return surfaces_.size(); }
  std::size_t bytes() const;

 private:
  struct Surface {
    Vec3 velocity{};
    Vec3 spin{};
    Vec3 centre{};
  };
  struct Cell {
    std::int32_t x, y, z;
  };
  // A wall that fluid sticks to.
  struct Link {
    Cell cell;
    std::uint8_t velocity;  // index of what arrives
    bool interpolated;      // false: half-way
    std::uint16_t surface;
    double share;  // q
  };
  struct Mirror {
    Cell cell;
    Cell from;
    std::uint8_t velocity;
    std::uint8_t sent;  // the mirrored velocity
  };

  void link_cell(const FlowSettings& settings, const SolidMap& solids, const Cell& cell);
  std::optional<Mirror> mirror_of(const FlowSettings& settings, const SolidMap& solids,
                                  const Cell& cell, std::size_t i) const;
  void cut(const Obstacle& obstacle, const SolidMap& solids, Link& link) const;
  // 6 w c.uw where the link meets the wall.
  double push(const Link& link) const;
  Vec3 meeting(const Link& link) const;

  CellBlocks blocks_;
  std::vector<Surface> surfaces_;
  std::vector<Link> links_;
  std::vector<Mirror> mirrors_;
};

}  // namespace grouser
