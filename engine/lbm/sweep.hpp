// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/lbm/collision.hpp"
#include "engine/lbm/populations.hpp"

namespace grouser {

/// The step that is due. Streaming is done in place by two alternating steps (Bailey, Myre, Walsh,
/// Lilja, Saar 2009). In between, what cell x receives along velocity i lies
///   before an even step  in i of x itself,
///   before an odd step   in the opposite of i, of the cell x - c(i) it came from,
/// and what x sent along i in the step before lies where its neighbour will look for it. Either
/// step reads and writes the same places for one cell, and no two cells share one: the order of
/// cells is free.
enum class Parity { kEven, kOdd };

/// Cells next to each other along x, in whole registers.
struct Span {
  std::ptrdiff_t begin = 0;   ///< place of the first cell, see Populations::at
  std::ptrdiff_t length = 0;  ///< a multiple of the register's lanes
};

/// Spans of one row of cells.
struct Row {
  std::ptrdiff_t begin = 0;  ///< place of the cell with x = 0
  std::size_t first_span = 0;
  std::size_t spans = 0;
};

/// Bytes by which each stream is fetched ahead: the processor's own prefetchers do not follow as
/// many streams as there are velocities.
inline constexpr std::ptrdiff_t kFetchAhead = 512;

/// What a sweep works on.
struct SweepRange {
  const Row* rows = nullptr;
  std::size_t count = 0;
  const Span* spans = nullptr;
  /// Cells from one end of a periodic row to the other; 0 when x is not periodic.
  std::ptrdiff_t period_x = 0;
};

namespace detail {

// Copies between the ghosts at the ends of one row and the cells they stand for, before an odd step
// and after it. Only this row's cells use those places.
template <class Set, class Real>
[[gnu::always_inline]] inline void ghosts_from_ends(Real* const* streams, std::ptrdiff_t row,
                                                    std::ptrdiff_t period) {
  unroll<Set::kVelocities>([&](auto i) GROUSER_INLINE {
    constexpr int c = Set::kSet.velocities[i].x;
    if constexpr (c == 1) streams[i][row + period - 1] = streams[i][row - 1];
    if constexpr (c == -1) streams[i][row] = streams[i][row + period];
  });
}
template <class Set, class Real>
[[gnu::always_inline]] inline void ends_from_ghosts(Real* const* streams, std::ptrdiff_t row,
                                                    std::ptrdiff_t period) {
  unroll<Set::kVelocities>([&](auto i) GROUSER_INLINE {
    constexpr int c = Set::kSet.velocities[i].x;
    if constexpr (c == 1) streams[i][row - 1] = streams[i][row + period - 1];
    if constexpr (c == -1) streams[i][row + period] = streams[i][row];
  });
}

}  // namespace detail

/// The walk of every sweep: cells of a register are read, collided and written where the step wants
/// them. Local.
/// @param begin_row,end_row called with each row before its cells are read and after all are
/// written
/// @param collide           called with f, the place of the first cell and the row; turns what
///                          arrives along each velocity into what leaves
template <class Set, class Real, Parity kParity, class Begin, class Collide, class End>
[[gnu::always_inline]] inline void walk(Populations<Real>& populations, const SweepRange& range,
                                        const Begin& begin_row, const Collide& collide,
                                        const End& end_row) {
  constexpr std::size_t kVelocities = Set::kVelocities;
  constexpr bool kOdd = kParity == Parity::kOdd;
  constexpr auto kLanes = static_cast<std::ptrdiff_t>(WideOf<Real>::kLanes);
  Real* streams[kVelocities];
  unroll<kVelocities>([&](auto i) GROUSER_INLINE {
    constexpr LatticeVelocity c = Set::kSet.velocities[i];
    streams[i] = populations.of(i);
    if constexpr (kOdd) streams[i] += populations.at(c.x, c.y, c.z);
  });
  for (const Row* row = range.rows; row != range.rows + range.count; ++row) {
    begin_row(*row);
    if (kOdd && range.period_x > 0)
      detail::ghosts_from_ends<Set>(streams, row->begin, range.period_x);
    const Span* const spans = range.spans + row->first_span;
    for (const Span* span = spans; span != spans + row->spans; ++span) {
      const std::ptrdiff_t end = span->begin + span->length;
      for (std::ptrdiff_t at = span->begin; at < end; at += kLanes) {
        Wide<Real> f[kVelocities];
        unroll<kVelocities>([&](auto i) GROUSER_INLINE {
          constexpr std::size_t from = kOdd ? opposite(i) : std::size_t{i};
          f[i] = load_wide(streams[from] + at);
          __builtin_prefetch(reinterpret_cast<const char*>(streams[from] + at) + kFetchAhead);
        });
        collide(f, at, *row);
        unroll<kVelocities>([&](auto i) GROUSER_INLINE {
          constexpr std::size_t to = kOdd ? std::size_t{i} : opposite(i);
          store_wide(streams[to] + at, f[i]);
        });
      }
    }
    if (kOdd && range.period_x > 0)
      detail::ends_from_ghosts<Set>(streams, row->begin, range.period_x);
    end_row(*row);
  }
}

/// Collides all cells of the rows and streams. Local.
template <class Set, class Real, bool kForced, Parity kParity, class Collide>
void sweep(Populations<Real>& populations, const Collide& collision, const Vec3T<Real>& force,
           const SweepRange& range) {
  const auto nothing = [](const Row&) {};
  walk<Set, Real, kParity>(
      populations, range, nothing,
      [&](Wide<Real>* f, std::ptrdiff_t, const Row&)
          GROUSER_INLINE { collision.template collide<Set, kForced>(f, force); },
      nothing);
}

}  // namespace grouser
