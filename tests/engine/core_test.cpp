// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "engine/core/communicator.hpp"
#include "engine/core/decomposition.hpp"
#include "engine/core/exact_sum.hpp"
#include "engine/core/state_io.hpp"

namespace grouser {
namespace {

TEST(ExactSum, DoesNotDependOnTheOrderOfItsTerms) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<double> terms(1000);
  for (double& term : terms) term = unit(random) * std::pow(10.0, 6.0 * unit(random));
  ExactSum forward;
  for (const double term : terms) forward.add(term);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(terms.begin(), terms.end(), random);
    ExactSum shuffled;
    for (const double term : terms) shuffled.add(term);
    EXPECT_EQ(forward.value(), shuffled.value());
  }
}

TEST(ExactSum, SurvivesItsLimbs) {
  for (const double value : {0.0, 1922.0, -1922.25, 1e-9, -3e15, 0x1p60, -0x1p60}) {
    ExactSum sum;
    sum.add(value);
    EXPECT_EQ(ExactSum::from_limbs(sum.limbs()).value(), sum.value());
    EXPECT_NEAR(sum.value(), value, 0x1p-59);
  }
}

TEST(Decomposition, EveryPointIsInTheBoxOfItsOnlyOwner) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> step(-8, 40);
  for (const int size : {1, 2, 3, 4, 6, 7, 8, 64, 96}) {
    const Decomposition boxes = Decomposition::even({0, 0, 0}, {2.0, 1.0, 0.25}, size);
    for (int i = 0; i < 300; ++i) {
      // In steps, so that many are on cuts; some are beyond the domain.
      const Vec3 at{step(random) * 0x1p-4, step(random) * 0x1p-5, step(random) * 0x1p-7};
      int owners = 0;
      for (int rank = 0; rank < size; ++rank) {
        const Box& box = boxes.box(rank);
        const bool is_in = at.x >= box.low.x && at.x < box.high.x && at.y >= box.low.y &&
                           at.y < box.high.y && at.z >= box.low.z && at.z < box.high.z;
        if (!is_in) continue;
        ++owners;
        EXPECT_EQ(boxes.owner_of(at), rank);
        EXPECT_EQ(box.distance2(at), 0.0);
      }
      EXPECT_EQ(owners, 1);
    }
  }
}

TEST(Decomposition, BoxesAreNearlyCubesOfTheSameVolume) {
  const Decomposition boxes = Decomposition::even({0, 0, 0}, {1.2192, 0.5334, 0.2006}, 512);
  for (int rank = 0; rank < 512; ++rank) {
    Box box = boxes.box(rank);
    box.low = {std::max(box.low.x, 0.0), std::max(box.low.y, 0.0), std::max(box.low.z, 0.0)};
    box.high = {std::min(box.high.x, 1.2192), std::min(box.high.y, 0.5334),
                std::min(box.high.z, 0.2006)};
    const Vec3 side = box.high - box.low;
    EXPECT_NEAR(side.x * side.y * side.z, 1.2192 * 0.5334 * 0.2006 / 512, 1e-12);
    // Each cut halves the longest side.
    EXPECT_LE(std::max({side.x, side.y, side.z}), 2.0001 * std::min({side.x, side.y, side.z}));
  }
}

TEST(Decomposition, NeighboursAreAllWithinReachOfBoxesHoweverThin) {
  // Five sheets, the second of them 1 mm thick.
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<Box> sheets;
  const double faces[] = {-kFar, 0.1, 0.101, 0.15, 0.3, kFar};
  for (int i = 0; i < 5; ++i)
    sheets.push_back({{faces[i], -kFar, -kFar}, {faces[i + 1], kFar, kFar}});
  std::swap(sheets[0], sheets[4]);
  const Decomposition boxes(sheets);
  EXPECT_EQ(boxes.neighbours(1, 0.01), (std::vector<int>{2, 4}));
  EXPECT_EQ(boxes.neighbours(2, 0.01), (std::vector<int>{1, 3, 4}));
  EXPECT_EQ(boxes.neighbours(4, 0.06), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(boxes.owner_of({0.0, 0.0, 0.0}), 4);
  EXPECT_EQ(boxes.owner_of({9.0, 0.0, 0.0}), 0);
  EXPECT_EQ(boxes.owner_of({0.1, 0.0, 0.0}), 1);
}

StateTable some_rows(const std::vector<std::int64_t>& keys) {
  StateTable table;
  table.name = "rows";
  table.key_count = 100;
  table.real_fields = {{"value", "m", 1}};
  for (const std::int64_t key : keys) {
    table.integers.insert(table.integers.end(), {key, 0});
    table.reals.push_back(0.5 * static_cast<double>(key));
  }
  return table;
}

TEST(StateIo, HashFollowsContentAndNotOrder) {
  const Communicator alone = Communicator::alone();
  EXPECT_EQ(hash_state(alone, {some_rows({1, 2, 3})}), hash_state(alone, {some_rows({3, 1, 2})}));
  StateTable other = some_rows({1, 2, 3});
  other.reals[1] = std::nextafter(other.reals[1], 2.0);
  EXPECT_NE(hash_state(alone, {some_rows({1, 2, 3})}), hash_state(alone, {other}));
}

TEST(StateIo, SortedRowsAreInKeyOrder) {
  StateTable table = some_rows({42, 7, 99, 0});
  sort_rows(Communicator::alone(), table);
  EXPECT_EQ(table.integers, (std::vector<std::int64_t>{0, 0, 7, 0, 42, 0, 99, 0}));
  EXPECT_EQ(table.reals, (std::vector<double>{0.0, 3.5, 21.0, 49.5}));
}

}  // namespace
}  // namespace grouser
