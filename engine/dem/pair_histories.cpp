// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/pair_histories.hpp"

namespace grouser {

void PairHistories::add(std::uint32_t grain, std::int64_t partner, const double* values) {
  if (grain / kBucket >= buckets_.size()) buckets_.resize(grain / kBucket + 1);
  Bucket& bucket = buckets_[grain / kBucket];
  if (bucket.grain.size() == bucket.grain.capacity()) {
    // By less than the usual factor of two, half of which would stand empty.
    const std::size_t room = bucket.grain.size() + bucket.grain.size() / 8 + 256;
    bucket.grain.reserve(room);
    bucket.partner.reserve(room);
    bucket.values.reserve(room * width_);
  }
  bucket.grain.push_back(grain);
  bucket.partner.push_back(partner);
  bucket.values.insert(bucket.values.end(), values, values + width_);
}

void PairHistories::sort() {
  for (Bucket& bucket : buckets_) {
    // Counted two places up, so that filling moves each mark to where the next grain begins.
    bucket.start.assign(kBucket + 2, 0);
    for (const std::uint32_t grain : bucket.grain) ++bucket.start[grain % kBucket + 2];
    for (std::size_t k = 2; k < bucket.start.size(); ++k) bucket.start[k] += bucket.start[k - 1];
    bucket.order.resize(bucket.grain.size());
    for (std::size_t r = 0; r < bucket.grain.size(); ++r)
      bucket.order[bucket.start[bucket.grain[r] % kBucket + 1]++] = static_cast<std::uint32_t>(r);
  }
}

const double* PairHistories::find(std::uint32_t grain, std::int64_t partner) const {
  if (grain / kBucket >= buckets_.size()) return nullptr;
  const Bucket& bucket = buckets_[grain / kBucket];
  if (bucket.start.empty()) return nullptr;
  const std::size_t at = grain % kBucket;
  for (std::uint32_t r = bucket.start[at]; r < bucket.start[at + 1]; ++r)
    if (bucket.partner[bucket.order[r]] == partner)
      return bucket.values.data() + bucket.order[r] * width_;
  return nullptr;
}

void PairHistories::free_bucket(std::size_t bucket) {
  if (bucket < buckets_.size()) buckets_[bucket] = Bucket{};
}

}  // namespace grouser
