// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/threads.hpp"

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "base/check.hpp"

namespace grouser {
namespace {

#ifdef _OPENMP
// One share per thread; if the system gives fewer threads, they do several shares one by one.
void start(std::size_t count, const std::function<void(std::size_t)>& work) {
  const int shares = static_cast<int>(count);
#pragma omp parallel for schedule(static, 1) num_threads(shares)
  for (int share = 0; share < shares; ++share) work(static_cast<std::size_t>(share));
}
#else
void start(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::vector<std::jthread> others;
  for (std::size_t share = 1; share < count; ++share) others.emplace_back(work, share);
  work(0);
}
#endif

}  // namespace

Threads::Threads(int count) : count_(static_cast<std::size_t>(count)) { GROUSER_CHECK(count >= 1); }

void Threads::run(const std::function<void(std::size_t share)>& work) const {
  if (count_ == 1) {
    work(0);
    return;
  }
  // An exception that leaves a thread would end the program without a word.
  std::vector<std::exception_ptr> failures(count_);
  start(count_, [&](std::size_t share) {
    try {
      work(share);
    } catch (...) {
      failures[share] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

void Threads::hand_out(std::size_t tasks,
                       const std::function<void(std::size_t task, std::size_t share)>& work) const {
  std::atomic<std::size_t> next{0};
  run([&](std::size_t share) {
    for (std::size_t task = next++; task < tasks; task = next++) work(task, share);
  });
}

void Threads::split(
    std::size_t items,
    const std::function<void(std::size_t first, std::size_t last, std::size_t share)>& work) const {
  run([&](std::size_t share) {
    work(share_begin(items, count_, share), share_begin(items, count_, share + 1), share);
  });
}

}  // namespace grouser
