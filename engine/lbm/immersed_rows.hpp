// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/lbm/ball_cover.hpp"
#include "engine/lbm/body_cover.hpp"
#include "engine/lbm/immersed.hpp"
#include "engine/lbm/solid_map.hpp"

namespace grouser {

/// What solids mean to one row of cells. A cell that they cover by the fraction e collides as
///   f + (1 - B) (plain collision) + B (s - f),   B = e t / (1 - e + t),  t = relaxation time -
///   1/2,
/// where s is f sent back, with the equilibria of the solids' velocity in place of the fluid's.
/// Source: Noble, Torczynski 1998, eqs. 12 to 16. Arrays are over x, in whole registers.
template <class Real>
struct SolidRow {
  std::vector<std::uint8_t> covered;          ///< of each register: whether a cell of it has B > 0
  std::vector<Real> weight;                   ///< B
  std::vector<Real> share;                    ///< B over the sum of the fractions; 0 where none
  std::array<std::vector<Real>, 3> velocity;  ///< of the solids, mean by fractions
  std::vector<Real> density;                  ///< of the fluid before the collision; found
  std::array<std::vector<Real>, 3> momentum;  ///< likewise

  explicit SolidRow(std::size_t cells);
};

/// Solids that move through the fluid of a rank's block (immersed moving boundary). Rows along x
/// are whole on one rank, so sums over a row are the same on any number of ranks. Where several
/// solids cover one cell, they share its B by their fractions; fractions that come to over 1
/// together count as 1.
/// Source: Noble, Torczynski 1998; Owen, Leonardi, Feng 2011 (several solids in one cell).
template <class Real>
class ImmersedRows {
 public:
  ImmersedRows(const CellBlocks& blocks, const CellBox& box, double viscosity_lu);

  /// Replaces the solids. Those that are off the block do no harm. Local.
  void immerse(const std::vector<ImmersedBall>& balls, const std::vector<ImmersedBody>& bodies);
  bool empty() const { return pieces_.empty(); }

  /// Works out what solids mean to row (y, z) of the block. @return whether one is there. Local.
  bool begin_row(std::int64_t y, std::int64_t z, const SolidMap& map);
  SolidRow<Real>& row() { return row_; }
  /// Adds up what the row's cells gave the solids. Local.
  void end_row();

  const std::vector<ImmersedLoad>& loads() const { return loads_; }
  void clear_loads() { loads_.assign(loads_.size(), {}); }
  std::size_t bytes() const;

 private:
  // A ball, or its image beyond a periodic end.
  struct Image {
    ImmersedBall ball;
    double radius = 0.0;  // see cover_radius
    std::uint32_t number = 0;
    std::int32_t body = -1;  // of a body, its number; `ball` then only says how it moves
  };
  // Cells of one row that an image may cover, in whole registers.
  struct Piece {
    std::uint32_t image;
    std::int32_t begin;
    std::int32_t length;
  };
  // A solid's velocity along a row: at the place of its centre, and its change per cell.
  struct Motion {
    Vec3T<Real> velocity;
    Real slope_y;
    Real slope_z;
  };

  void add_images(const ImmersedBall& ball, std::uint32_t number);
  void add_pieces(std::uint32_t image);
  void add_body(const ImmersedBody& body, std::uint32_t number);
  void add_piece(std::uint32_t image, std::int64_t y, std::int64_t z, std::int64_t begin,
                 std::int64_t end);
  void sort_pieces();
  void cover(const Piece& piece, std::int64_t length, float* fractions) const;
  Motion motion_of(const Piece& piece) const;
  void clear_beyond_fluid(const Piece& piece, const SolidMap& map, float* fractions) const;
  void fill(const Piece& piece, const float* fractions);
  void weigh(std::size_t begin, std::size_t end);
  void take(const Piece& piece, const float* fractions);

  std::int64_t row_number(std::int64_t y, std::int64_t z) const { return z * box_.ny + y; }

  CellBlocks blocks_;
  CellBox box_;
  Real time_;  // t
  SolidRow<Real> row_;
  std::vector<BodyCover> bodies_;
  std::vector<Image> images_;
  std::vector<Piece> pieces_;          // sorted by row
  std::vector<std::uint32_t> starts_;  // of each row's pieces, and the end
  std::vector<std::uint32_t> rows_;    // of pieces as they are found
  std::vector<Piece> found_;
  std::vector<float> fractions_;  // of the row's pieces, one after the other
  std::vector<ImmersedLoad> loads_;
  std::int64_t y_ = 0;  // of the row begun
  std::int64_t z_ = 0;
};

}  // namespace grouser
