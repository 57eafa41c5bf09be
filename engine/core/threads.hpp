// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace grouser {

/// The threads of one rank. The only place that knows of OpenMP; a program built without it takes
/// the threads of the C++ library, slower to start, with the same bits.
///
/// Work is cut into shares that write to places of their own, so no result may depend on how many
/// shares there are, on who does them or when. Work must not call MPI (only the first thread may)
/// nor give work to threads itself. An exception ends the other shares no earlier than they end
/// themselves; then that of the lowest share is thrown on. Local.
class Threads {
 public:
  explicit Threads(int count = 1);

  std::size_t count() const { return count_; }

  /// Calls work(share) for every share 0 ... count()-1, each on a thread of its own; returns when
  /// all have ended.
  void run(const std::function<void(std::size_t share)>& work) const;

  /// Calls work(task, share) for every task 0 ... tasks-1; a thread that is free takes the next.
  /// `share` tells threads apart.
  void hand_out(std::size_t tasks,
                const std::function<void(std::size_t task, std::size_t share)>& work) const;

  /// Cuts `items` into count() consecutive ranges of equal size and calls work(first, last, share)
  /// for each.
  void split(std::size_t items,
             const std::function<void(std::size_t first, std::size_t last, std::size_t share)>&
                 work) const;

 private:
  std::size_t count_;
};

/// Where share `share` of `count` equal ones begins among `items`.
inline std::size_t share_begin(std::size_t items, std::size_t count, std::size_t share) {
  return items / count * share + items % count * share / count;
}

}  // namespace grouser
