// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace grouser {

/// Histories of pairs while no list holds them: between two lists, on their way to another rank,
/// or after a restart. Each is kept under one of its two grains, or under both, and named by the
/// other's id. In buckets of neighbouring grains, so that what has been taken can be freed early.
class PairHistories {
 public:
  static constexpr std::size_t kBucket = 4096;  ///< grains per bucket

  explicit PairHistories(std::size_t width) : width_(width) {}

  std::size_t width() const { return width_; }
  bool empty() const { return buckets_.empty(); }

  /// @param values `width` numbers
  void add(std::uint32_t grain, std::int64_t partner, const double* values);

  /// Makes what was added ready for find and each_of.
  void sort();

  /// The history kept under `grain` with that partner, or null.
  const double* find(std::uint32_t grain, std::int64_t partner) const;

  /// Calls visit(partner, values) for each history kept under `grain`.
  template <class Visit>
  void each_of(std::uint32_t grain, const Visit& visit) const {
    if (grain / kBucket >= buckets_.size()) return;
    const Bucket& bucket = buckets_[grain / kBucket];
    if (bucket.start.empty()) return;
    const std::size_t at = grain % kBucket;
    for (std::uint32_t r = bucket.start[at]; r < bucket.start[at + 1]; ++r) {
      const std::size_t record = bucket.order[r];
      visit(bucket.partner[record], bucket.values.data() + record * width_);
    }
  }

  /// Calls visit(grain, partner, values) for all.
  template <class Visit>
  void each(const Visit& visit) const {
    for (const Bucket& bucket : buckets_)
      for (std::size_t r = 0; r < bucket.grain.size(); ++r)
        visit(bucket.grain[r], bucket.partner[r], bucket.values.data() + r * width_);
  }

  /// The same, and frees each bucket when it has been visited.
  template <class Visit>
  void drain(const Visit& visit) {
    for (Bucket& bucket : buckets_) {
      for (std::size_t r = 0; r < bucket.grain.size(); ++r)
        visit(bucket.grain[r], bucket.partner[r], bucket.values.data() + r * width_);
      bucket = Bucket{};
    }
    buckets_.clear();
  }

  /// Forgets all under the grains of one bucket.
  void free_bucket(std::size_t bucket);
  void clear() { buckets_.clear(); }

 private:
  struct Bucket {
    std::vector<std::uint32_t> grain;
    std::vector<std::int64_t> partner;
    std::vector<double> values;
    std::vector<std::uint32_t> start;  // of each grain's records in `order`
    std::vector<std::uint32_t> order;
  };

  std::size_t width_;
  std::vector<Bucket> buckets_;
};

}  // namespace grouser
