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

void World::cut_if_uneven() {
  if (ranks_.size() == 1) return;
  bool is_uneven = is_loaded_;
  if (!is_loaded_) {
    if (busy_steps_ < kLeastSteps) return;
    Communicator::StepTotals totals;
    totals.sums.resize(1);
    totals.sums[0].add(busy_);
    totals.maxima = {busy_};
    ranks_.combine(totals);
    is_uneven = totals.maxima[0] * ranks_.size() > settings_.uneven * totals.sums[0].value();
  }
  if (is_uneven) {
    if (is_loaded_) busy_steps_ = 0;
    cut_by(costs());
  }
  is_loaded_ = false;
  busy_ = 0.0;
  busy_steps_ = 0;
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
