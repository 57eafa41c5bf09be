// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/sweep_plan.hpp"

#include <algorithm>
#include <limits>

#include "base/check.hpp"

namespace grouser {

void SweepPlan::make(std::size_t threads) {
  cut(threads);
  look_back();
  place();
}

// Equal work for all, taking a grain's sums and motion for as long as a slot.
void SweepPlan::cut(std::size_t threads) {
  std::size_t all = 0;
  for (const Chunk& chunk : chunks) all += chunk.slots + kChunk;
  shares.assign(threads, {});
  std::size_t done = 0;
  std::size_t at = 0;
  for (std::size_t s = 0; s < threads; ++s) {
    shares[s].first = at;
    while (at < chunks.size() && (s + 1 == threads || done * threads < all * (s + 1)))
      done += chunks[at++].slots + kChunk;
    shares[s].last = at;
  }
}

void SweepPlan::look_back() {
  std::size_t reached = 0;  // chunks before it know how far they look back
  for (std::size_t c = 0; c < chunks.size(); ++c)
    for (; reached <= std::max<std::size_t>(c, chunks[c].front); ++reached)
      chunks[reached].back = static_cast<std::uint32_t>(c);
  for (const Share& share : shares)
    for (std::size_t c = share.first; c < share.last; ++c)
      chunks[c].is_late = chunks[c].back < share.first;
}

void SweepPlan::place() {
  std::vector<bool> is_kept(chunks.size(), false);
  for (std::size_t c = 0; c < chunks.size(); ++c)
    if (chunks[c].is_late)
      std::fill(is_kept.begin() + chunks[c].back,
                is_kept.begin() + static_cast<std::ptrdiff_t>(c) + 1, true);

  results = 0;
  std::vector<std::size_t> before(chunks.size() + 1, 0);  // slots that pass through rings
  for (std::size_t c = 0; c < chunks.size(); ++c)
    before[c + 1] = before[c] + (is_kept[c] ? 0 : chunks[c].slots);
  for (const Share& share : shares) {
    std::size_t window = 0;
    std::size_t largest = 0;
    for (std::size_t c = share.first; c < share.last; ++c) {
      Chunk& chunk = chunks[c];
      if (is_kept[c]) {
        chunk.place = static_cast<std::uint32_t>(results);
        results += chunk.slots;
        continue;
      }
      window = std::max(window, before[c + 1] - before[chunk.back]);
      largest = std::max<std::size_t>(largest, chunk.slots);
    }
    // A chunk that does not fit before the ring's end begins anew; less than its size stays empty.
    const std::size_t room = window + largest;
    std::size_t at = 0;
    for (std::size_t c = share.first; c < share.last; ++c) {
      if (is_kept[c]) continue;
      if (at + chunks[c].slots > room) at = 0;
      chunks[c].place = static_cast<std::uint32_t>(results + at);
      at += chunks[c].slots;
    }
    results += room;
  }
  // A place and a side share 32 bits.
  GROUSER_CHECK(results < std::numeric_limits<std::int32_t>::max());
}

}  // namespace grouser
