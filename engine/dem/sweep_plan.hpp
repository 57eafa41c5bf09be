// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace grouser {

/// Which thread evaluates which pairs, when grains may be added up, and where results wait until
/// then. The plan decides about time and memory only: whatever it says, results are the same bits.
///
/// Grains are taken in chunks of kChunk, in the order of memory; the slots of a chunk are those
/// listed under its grains. A grain's slots stand in its own chunk and in earlier ones, never in
/// later ones. So two rules are enough, and chunks may else be evaluated in any order:
/// - a chunk may be added up, and its grains moved, when the chunks from its `back` to itself have
///   been evaluated: nobody else needs its grains' positions any more;
/// - the results of a chunk must stay until all chunks that look back to it have been added up.
/// Each share is a run of neighbouring chunks which one thread evaluates in order. A chunk that
/// looks back into another share is late: it is added up when all shares have been evaluated. All
/// that late chunks look back to is kept; other results stand in a ring that fits the nearest
/// caches.
struct SweepPlan {
  static constexpr std::size_t kChunk = 256;  ///< grains

  struct Chunk {
    std::uint32_t slots = 0;
    std::uint32_t front = 0;  ///< last chunk of an owned grain that these slots act on
    std::uint32_t back = 0;   ///< first chunk with slots that act on grains of this one
    std::uint32_t place = 0;  ///< of the first slot's result among all results
    bool is_late = false;
    bool has_ghosts = false;  ///< whether a slot has one
  };
  struct Share {
    std::size_t first = 0;  ///< chunks first ... last-1
    std::size_t last = 0;
  };

  std::vector<Chunk> chunks;
  std::vector<Share> shares;
  std::size_t results = 0;  ///< places for results, in slots

  /// Makes a plan for `threads` shares of chunks whose `slots` and `front` are known.
  void make(std::size_t threads);

 private:
  void cut(std::size_t threads);
  void look_back();
  void place();
};

}  // namespace grouser
