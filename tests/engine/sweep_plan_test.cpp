// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>
#include <stdexcept>

#include "engine/core/threads.hpp"
#include "engine/dem/sweep_plan.hpp"

namespace grouser {
namespace {

// Chunks whose slots act up to `reach` chunks ahead.
SweepPlan random_plan(std::size_t chunks, std::size_t reach, std::size_t threads,
                      std::mt19937_64& random) {
  SweepPlan plan;
  for (std::size_t c = 0; c < chunks; ++c) {
    SweepPlan::Chunk chunk;
    chunk.slots = 8 * static_cast<std::uint32_t>(random() % 100);
    chunk.front = static_cast<std::uint32_t>(std::min(c + random() % (reach + 1), chunks - 1));
    plan.chunks.push_back(chunk);
  }
  plan.make(threads);
  return plan;
}

// Does what a sweep does, one chunk of any share at a time, and looks whether results are where
// they are looked for.
void act(const SweepPlan& plan, std::mt19937_64& random) {
  std::vector<std::int64_t> results(plan.results, -1);
  std::vector<bool> is_evaluated(plan.chunks.size(), false);
  std::vector<bool> is_added(plan.chunks.size(), false);
  const auto add_up = [&](std::size_t c) {
    // Which earlier chunks act on this one follows from their fronts, not from the plan.
    for (std::size_t from = 0; from <= c; ++from) {
      if (from != c && plan.chunks[from].front < c) continue;
      ASSERT_TRUE(is_evaluated[from]);
      for (std::size_t slot = 0; slot < plan.chunks[from].slots; ++slot)
        ASSERT_EQ(results[plan.chunks[from].place + slot], static_cast<std::int64_t>(from));
    }
    is_added[c] = true;
  };
  std::vector<std::size_t> next;
  for (const SweepPlan::Share& share : plan.shares) next.push_back(share.first);
  for (std::size_t left = plan.chunks.size(); left > 0;) {
    const std::size_t s = random() % next.size();
    if (next[s] == plan.shares[s].last) continue;
    const std::size_t c = next[s]++;
    --left;
    for (std::size_t at = c; at <= plan.chunks[c].front; ++at) ASSERT_FALSE(is_added[at]);
    std::fill_n(results.begin() + plan.chunks[c].place, plan.chunks[c].slots,
                static_cast<std::int64_t>(c));
    is_evaluated[c] = true;
    if (!plan.chunks[c].is_late) add_up(c);
  }
  std::vector<std::size_t> late(plan.chunks.size());
  std::iota(late.begin(), late.end(), std::size_t{0});
  std::shuffle(late.begin(), late.end(), random);
  for (const std::size_t c : late)
    if (plan.chunks[c].is_late) add_up(c);
  EXPECT_EQ(std::count(is_added.begin(), is_added.end(), true),
            static_cast<std::ptrdiff_t>(plan.chunks.size()));
}

TEST(SweepPlan, ResultsWaitForTheirGrainsWhoeverIsFaster) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    const std::size_t threads = 1 + random() % 6;
    const SweepPlan plan = random_plan(random() % 60, random() % 9, threads, random);
    ASSERT_EQ(plan.shares.size(), threads);
    act(plan, random);
    if (testing::Test::HasFailure()) FAIL() << "round " << round << ", " << threads << " threads";
  }
}

TEST(SweepPlan, OneThreadNeedsNoMoreThanARing) {
  std::mt19937_64 random(12);
  const SweepPlan plan = random_plan(5000, 5, 1, random);
  // Six chunks at most are looked back over, of less than 800 slots each, and one to turn round.
  EXPECT_LT(plan.results, 7u * 800u);
  EXPECT_TRUE(std::none_of(plan.chunks.begin(), plan.chunks.end(),
                           [](const auto& chunk) { return chunk.is_late; }));
}

TEST(SweepPlan, SharesAreOfEqualWork) {
  std::mt19937_64 random(13);
  const SweepPlan plan = random_plan(400, 5, 4, random);
  for (const SweepPlan::Share& share : plan.shares) {
    std::size_t slots = 0;
    for (std::size_t c = share.first; c < share.last; ++c)
      slots += plan.chunks[c].slots + SweepPlan::kChunk;
    // A quarter, to within a chunk or two.
    EXPECT_NEAR(static_cast<double>(slots), 100 * (396.0 + 256.0), 0.1 * 100 * 652.0);
  }
}

TEST(Threads, DoEachTaskOnceAndEachItemOnce) {
  for (const int count : {1, 2, 3, 7}) {
    const Threads threads(count);
    std::vector<int> done(1000, 0);
    threads.hand_out(done.size(), [&](std::size_t task, std::size_t share) {
      ASSERT_LT(share, threads.count());
      ++done[task];
    });
    threads.split(done.size(), [&](std::size_t first, std::size_t last, std::size_t) {
      for (std::size_t i = first; i < last; ++i) ++done[i];
    });
    EXPECT_EQ(std::count(done.begin(), done.end(), 2), 1000) << count << " threads";
  }
}

TEST(Threads, AnExceptionIsThrownOnAfterTheOthersHaveEnded) {
  const Threads threads(4);
  std::atomic<int> ended{0};
  try {
    threads.run([&](std::size_t share) {
      if (share == 2 || share == 3) throw std::runtime_error("share " + std::to_string(share));
      ++ended;
    });
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "share 2");
  }
  EXPECT_EQ(ended, 2);
}

}  // namespace
}  // namespace grouser
