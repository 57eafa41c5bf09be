// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace grouser {

/// A sum whose result does not depend on the order of its terms, and so not on ranks or threads:
/// terms are cut to multiples of 2^-60 and added as 128-bit integers.
/// Terms must be finite and below 2^66 in magnitude; SI forces, torques and energies of any run
/// are. A term loses at most 2^-60 of its unit. Local, except where Communicator combines limbs.
class ExactSum {
 public:
  /// 32-bit digits held in 64-bit words, so that 2^31 ranks can be added without carry.
  using Limbs = std::array<std::int64_t, 4>;

  void add(double term) {
    // What a cast to Integer does, without its call: mantissa, shift, sign.
    const auto bits = std::bit_cast<std::uint64_t>(term * kScale);
    const int shift = static_cast<int>(bits >> 52 & 0x7FF) - 1075;
    const std::uint64_t mantissa = (bits & 0xFFFFFFFFFFFFF) | 0x10000000000000;
    if (shift < -52) return;
    const Integer size = shift < 0 ? static_cast<Integer>(mantissa >> -shift)
                                   : static_cast<Integer>(mantissa) << shift;
    sum_ += (bits >> 63) != 0 ? -size : size;
  }
  void add(const ExactSum& other) { sum_ += other.sum_; }
  double value() const { return static_cast<double>(sum_) * (1.0 / kScale); }

  Limbs limbs() const {
    Limbs out{};
    Integer rest = sum_;
    for (std::size_t i = 0; i < 3; ++i) {
      out[i] = static_cast<std::int64_t>(rest & 0xFFFFFFFF);
      rest >>= 32;
    }
    out[3] = static_cast<std::int64_t>(rest);
    return out;
  }

  static ExactSum from_limbs(const Limbs& limbs) {
    ExactSum out;
    for (std::size_t i = 4; i-- > 0;) out.sum_ = out.sum_ * kDigit + limbs[i];
    return out;
  }

 private:
  __extension__ using Integer = __int128;
  static constexpr double kScale = 0x1p60;
  static constexpr Integer kDigit = Integer{1} << 32;
  Integer sum_ = 0;
};

}  // namespace grouser
