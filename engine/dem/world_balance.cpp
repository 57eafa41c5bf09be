// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>

#include "base/check.hpp"
#include "engine/core/balance.hpp"
#include "engine/dem/world.hpp"

namespace grouser {
namespace {

// Steps whose time is added up before ranks are compared: single ones are too short to tell.
constexpr int kLeastSteps = 32;

// Lists of a bed at rest live long: after so many steps, twice as many the next time, grains are
// shared out without waiting for new lists, when that is worth their cost.
constexpr int kPatience = 128;
constexpr int kMostPatience = 1 << 20;
constexpr double kWorthNewLists = 1.2;

// What ranks tell of their grains when space is cut: enough for shares to be even to 1 %.
constexpr std::size_t kLoads = 8192;

// Costs relative to each other: of moving a grain, of a pair as seen from one of its grains, of a
// grain that touches a body. Each rank's sum is then scaled to the time it took.
constexpr double kGrainCost = 0.4;
constexpr double kPairCost = 0.12;
constexpr double kBodyCost = 1.0;

}  // namespace

// What each owned grain costs in a step, by the lists of the last rebuild and the time since then
// [s]; a grain is a grain where nothing is known.
std::vector<double> World::costs() const {
  std::vector<double> costs(owned_, 1.0);
  if (busy_steps_ == 0) return costs;
  for (std::size_t i = 0; i < owned_; ++i)
    costs[i] = kGrainCost + kPairCost * static_cast<double>(pairs_.slots_of(i));
  for (const BodyContacts& contacts : body_contacts_)
    contacts.each_touch(
        0, owned_, [&](std::uint32_t grain, int, const double*) { costs[grain] += kBodyCost; });
  const double sum = std::accumulate(costs.begin(), costs.end(), 0.0);
  for (double& cost : costs) cost *= busy_ / busy_steps_ / sum;
  return costs;
}

// Largest over mean number of grains that ranks would have if all were with their owners.
double World::unevenness_of_counts() const {
  std::vector<std::int64_t> counts(static_cast<std::size_t>(ranks_.size()), 0);
  for (std::size_t i = 0; i < owned_; ++i)
    ++counts[static_cast<std::size_t>(boxes_.owner_of(particles_[i].position))];
  Communicator::StepTotals totals;
  totals.sums.resize(counts.size());
  for (std::size_t r = 0; r < counts.size(); ++r)
    totals.sums[r].add(static_cast<double>(counts[r]));
  ranks_.combine(totals);
  double most = 0.0;
  for (const ExactSum& sum : totals.sums) most = std::max(most, sum.value());
  return most * ranks_.size() / static_cast<double>(count_);
}

void World::cut_if_uneven() {
  if (ranks_.size() == 1 || count_ == 0) return;
  if (is_new_) {
    busy_steps_ = 0;
    is_uneven_ = unevenness_of_counts() > settings_.uneven;
    is_new_ = false;
  } else if (busy_steps_ < kLeastSteps) {
    return;
  }
  if (is_uneven_) cut_by(costs());
  is_uneven_ = false;
  busy_ = 0.0;
  busy_steps_ = 0;
}

// Takes note of the ranks' times in the last steps, and tells whether not to wait for new lists.
bool World::looks_uneven(double most, double sum) {
  if (ranks_.size() == 1 || busy_steps_ < kLeastSteps) return false;
  const double excess = most * ranks_.size() / sum;
  is_uneven_ = excess > settings_.uneven;
  patience_ = std::max(patience_, kPatience);
  if (busy_steps_ < patience_) return false;
  if (is_uneven_ && excess > kWorthNewLists) {
    patience_ = std::min(2 * patience_, kMostPatience);
    return true;
  }
  is_uneven_ = false;
  busy_ = 0.0;
  busy_steps_ = 0;
  return false;
}

void World::cut_by(const std::vector<double>& weights) {
  GROUSER_CHECK(weights.size() == owned_);
  if (ranks_.size() == 1) return;
  // Grains that follow one another are neighbours in space: one stands for some.
  const std::size_t some = 1 + owned_ / kLoads;
  std::vector<Load> loads;
  for (std::size_t i = 0; i < owned_; ++i) {
    if (i % some == 0) loads.push_back({particles_[i].position, 0.0});
    loads.back().weight += weights[i];
  }
  const std::optional<Decomposition> boxes = balanced(ranks_, loads);
  if (!boxes) return;
  boxes_ = *boxes;
  ++cuts_;
  neighbours_ = boxes_.neighbours(ranks_.rank(), 2.0 * settings_.largest_radius + settings_.skin);
  must_rebuild_ = true;
  may_be_far_ = true;
}

}  // namespace grouser
