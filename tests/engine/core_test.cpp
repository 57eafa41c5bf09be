// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/errors.hpp"
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

TEST(Decomposition, EveryPointHasExactlyTheOwnerWhoseColumnHoldsIt) {
  const Vec3 low{0.0, 0.0, 0.0};
  const Vec3 high{1.2, 0.5, 0.3};
  for (const int size : {1, 2, 3, 4, 6}) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 200; ++i) {
      const Vec3 at{1.2 * unit(random), 0.5 * unit(random), 0.1};
      const Decomposition first(low, high, size, 0, 0.01);
      const Decomposition own(low, high, size, first.owner_of(at), 0.01);
      EXPECT_GE(at.x, own.low_x() - 1e-12);
      EXPECT_LE(at.x, own.high_x() + 1e-12);
      EXPECT_GE(at.y, own.low_y() - 1e-12);
      EXPECT_LE(at.y, own.high_y() + 1e-12);
    }
  }
}

TEST(Decomposition, RefusesMoreRanksThanTheBoxHasRoomFor) {
  EXPECT_THROW(Decomposition({0, 0, 0}, {0.1, 0.1, 0.1}, 64, 0, 0.02), ConfigError);
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
