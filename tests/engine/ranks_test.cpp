// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "engine/core/balance.hpp"
#include "engine/core/halo.hpp"
#include "tests/engine/small_world.hpp"

namespace grouser {
namespace {

// Run under mpirun with any number of ranks.

constexpr double kLargest = 5e-3;
constexpr double kSkin = 1e-3;

// A weight whose few large values draw cuts together: some boxes are thin sheets, some empty.
double lopsided(std::mt19937_64& random) {
  return std::pow(std::uniform_real_distribution<double>(0.0, 1.0)(random), 20.0);
}

// The same grains on every rank; of one size and in steps, so that many stand exactly on cuts.
std::vector<Particle> stepped_grains(int count, std::mt19937_64& random) {
  std::uniform_int_distribution<int> step(0, 63);
  std::vector<Particle> grains;
  for (int i = 0; i < count; ++i)
    grains.push_back(sphere(i, i % 3 == 0 ? kLargest : 0.4 * kLargest,
                            {step(random) * 0x1p-9, step(random) * 0x1p-9, step(random) * 0x1p-9}));
  return grains;
}

std::vector<Load> share_of(const std::vector<Particle>& grains, const Communicator& ranks,
                           std::mt19937_64& random) {
  std::vector<Load> loads;
  for (const Particle& p : grains) {
    const double weight = lopsided(random);
    if (p.id % ranks.size() == ranks.rank()) loads.push_back({p.position, weight});
  }
  return loads;
}

void expect_the_same_on_all(const Decomposition& boxes, const Communicator& ranks) {
  for (int rank = 0; rank < ranks.size(); ++rank) {
    const Box& box = boxes.box(rank);
    for (const double face : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z})
      ASSERT_EQ(ranks.max(face), -ranks.max(-face)) << "rank " << rank;
  }
}

TEST(Balance, SharesOfRandomWeightsAreEvenAndTheSameOnAllRanks) {
  const Communicator ranks;
  if (ranks.size() == 1) return;  // nothing to share
  std::mt19937_64 random(11 + static_cast<unsigned>(ranks.rank()));
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Load> loads;
  // A heap: most of the weight in a corner.
  for (int i = 0; i < 4000; ++i)
    loads.push_back({{std::pow(unit(random), 3.0), 0.4 * unit(random), 0.2 * unit(random)},
                     0.5 + unit(random)});
  const Decomposition boxes = balanced(ranks, loads).value();
  Communicator::StepTotals totals;
  totals.sums.resize(static_cast<std::size_t>(ranks.size()));
  for (const Load& load : loads)
    totals.sums[static_cast<std::size_t>(boxes.owner_of(load.position))].add(load.weight);
  ranks.combine(totals);
  double sum = 0.0;
  double largest = 0.0;
  for (const ExactSum& one : totals.sums) {
    sum += one.value();
    largest = std::max(largest, one.value());
  }
  // One per cent is allowed to each of the three halvings of eight ranks.
  EXPECT_LT(largest * ranks.size() / sum, 1.03);
  expect_the_same_on_all(boxes, ranks);
}

TEST(Balance, FewLoadsOfLittleWeightGiveTheSameBoxesOnAllRanks) {
  const Communicator ranks;
  if (ranks.size() == 1) return;
  std::mt19937_64 random(5);  // the same on all ranks
  std::uniform_int_distribution<int> place(0, 3);
  std::uniform_int_distribution<int> holder(0, ranks.size() - 1);
  for (int trial = 0; trial < 400; ++trial) {
    const int count = trial % (2 * ranks.size());
    const double weight = trial % 3 == 0 ? 0.0 : trial % 3 == 1 ? 1e-9 : 1.0;
    std::vector<Load> loads;
    for (int i = 0; i < count; ++i) {
      const Load load{{0.1 * place(random), 0.1 * place(random), 0.1 * place(random)}, weight};
      if (holder(random) == ranks.rank()) loads.push_back(load);
    }
    SCOPED_TRACE("trial " + std::to_string(trial));
    const std::optional<Decomposition> boxes = balanced(ranks, loads);
    const std::int64_t is_cut = boxes ? 1 : 0;
    ASSERT_EQ(ranks.max(is_cut), -ranks.max(-is_cut));
    if (boxes) expect_the_same_on_all(*boxes, ranks);
  }
}

TEST(Balance, ABedThatLiesInACornerIsSharedOutAtTheFirstStep) {
  const Communicator ranks;
  WorldSettings settings = small_settings();
  settings.gravity = 0.0;
  World world(ranks, settings);
  constexpr int kCount = 512;
  // At rest and apart: lists are never made anew, so nothing else would share them out.
  for (int i = 0; i < kCount; ++i)
    if (i % ranks.size() == ranks.rank())
      world.add_particle(sphere(
          i, 2e-3, {0.005 * (i % 8 + 0.5), 0.005 * (i / 8 % 8 + 0.5), 0.005 * (i / 64 + 0.5)}));
  ASSERT_EQ(world.step().fault, Fault::kNone);
  // Cuts go between layers of 64 grains in rows of 8.
  EXPECT_LE(ranks.max(static_cast<std::int64_t>(world.owned())) * ranks.size(),
            kCount + 64 * ranks.size());
  EXPECT_EQ(world.particle_count(), kCount);
}

TEST(Halo, HasEveryGrainThatAnOwnedOneMayTouchAndNoOtherHoweverNarrowTheBoxes) {
  const Communicator ranks;
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    std::mt19937_64 random(seed);
    std::vector<Particle> grains = stepped_grains(300, random);
    const Decomposition boxes = ranks.size() == 1 || seed == 1
                                    ? Decomposition::even({0, 0, 0}, {0.1, 0.1, 0.1}, ranks.size())
                                    : balanced(ranks, share_of(grains, ranks, random)).value();
    std::vector<Particle> here;
    for (const Particle& p : grains)
      if (boxes.owner_of(p.position) == ranks.rank()) here.push_back(p);
    ASSERT_EQ(ranks.sum(static_cast<std::int64_t>(here.size())), 300);
    const std::size_t owned = here.size();
    std::map<std::int64_t, int> expected;
    for (std::size_t i = 0; i < owned; ++i)
      for (const Particle& q : grains)
        if (boxes.owner_of(q.position) != ranks.rank() && is_within(here[i], q, kSkin))
          expected[q.id] = 1;
    Halo halo(ranks);
    halo.build(ranks, boxes, boxes.neighbours(ranks.rank(), 2.0 * kLargest + kSkin), kLargest,
               kSkin, here);
    std::map<std::int64_t, int> found;
    for (std::size_t g = owned; g < here.size(); ++g) ++found[here[g].id];
    ASSERT_EQ(found, expected) << "seed " << seed;
    for (std::size_t i = 0; i < owned; ++i)
      here[i].velocity.x = 0.5 * static_cast<double>(here[i].id);
    halo.start(here);
    halo.finish();
    for (const Particle& p : here) ASSERT_EQ(p.velocity.x, 0.5 * static_cast<double>(p.id));
  }
}

}  // namespace
}  // namespace grouser
