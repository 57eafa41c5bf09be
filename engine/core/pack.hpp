// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "engine/core/vec3.hpp"

#ifdef __AVX__
#include <immintrin.h>
#endif

namespace grouser {

/// Four numbers that one instruction works on. Every operation rounds as the same operation on a
/// double does, so code written for a type `Real` gives the same bits with double and with Pack,
/// on any processor.
class Pack {
 public:
  static constexpr std::size_t kLanes = 4;
  using Lanes = double __attribute__((vector_size(32)));
  using Bits = std::int64_t __attribute__((vector_size(32)));

  Pack() = default;
  Pack(double all) : lanes_{all, all, all, all} {}
  explicit Pack(Lanes lanes) : lanes_(lanes) {}

  /// @param from four numbers, aligned to 32 bytes
  static Pack load(const double* from) { return Pack(*reinterpret_cast<const Aliased*>(from)); }
  void store(double* to) const { *reinterpret_cast<Aliased*>(to) = lanes_; }

  Lanes lanes() const { return lanes_; }
  double operator[](std::size_t lane) const { return lanes_[lane]; }

  Pack& operator+=(const Pack& o) {
    lanes_ += o.lanes_;
    return *this;
  }
  Pack& operator-=(const Pack& o) {
    lanes_ -= o.lanes_;
    return *this;
  }
  Pack& operator*=(const Pack& o) {
    lanes_ *= o.lanes_;
    return *this;
  }
  friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.lanes_ + b.lanes_); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.lanes_ - b.lanes_); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.lanes_ * b.lanes_); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.lanes_ / b.lanes_); }
  friend Pack operator-(const Pack& a) { return Pack(-a.lanes_); }

 private:
  using Aliased = double __attribute__((vector_size(32), may_alias));

  Lanes lanes_{};
};

/// A truth per lane.
class PackMask {
 public:
  explicit PackMask(Pack::Bits bits) : bits_(bits) {}

  Pack::Bits bits() const { return bits_; }
  bool operator[](std::size_t lane) const { return bits_[lane] != 0; }
  /// Bit k is lane k.
  unsigned to_unsigned() const {
#ifdef __AVX__
    return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(bits_)));
#else
    return (bits_[0] != 0 ? 1u : 0u) | (bits_[1] != 0 ? 2u : 0u) | (bits_[2] != 0 ? 4u : 0u) |
           (bits_[3] != 0 ? 8u : 0u);
#endif
  }
  friend PackMask operator!(const PackMask& a) { return PackMask(~a.bits_); }
  friend PackMask operator&(const PackMask& a, const PackMask& b) {
    return PackMask(a.bits_ & b.bits_);
  }

 private:
  Pack::Bits bits_;
};

inline PackMask operator<(const Pack& a, const Pack& b) { return PackMask(a.lanes() < b.lanes()); }
inline PackMask operator>(const Pack& a, const Pack& b) { return PackMask(a.lanes() > b.lanes()); }
inline PackMask operator>=(const Pack& a, const Pack& b) {
  return PackMask(a.lanes() >= b.lanes());
}

inline Pack sqrt(const Pack& a) {
#ifdef __AVX__
  return Pack(_mm256_sqrt_pd(a.lanes()));
#else
  Pack::Lanes root;
  for (std::size_t lane = 0; lane < Pack::kLanes; ++lane) root[lane] = std::sqrt(a[lane]);
  return Pack(root);
#endif
}

/// `yes` where the mask is true, else `no`. The same word for one number.
inline Pack select(const PackMask& mask, const Pack& yes, const Pack& no) {
  return Pack(mask.bits() ? yes.lanes() : no.lanes());
}
inline double select(bool mask, double yes, double no) { return mask ? yes : no; }
template <class Mask, class Real>
Vec3T<Real> select(const Mask& mask, const Vec3T<Real>& yes, const Vec3T<Real>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

inline bool any(const PackMask& mask) { return mask.to_unsigned() != 0; }
inline bool any(bool mask) { return mask; }

/// Rows to columns: row k becomes lane k of the four results.
inline void transpose(Pack& a, Pack& b, Pack& c, Pack& d) {
  const Pack::Lanes ab_even = __builtin_shufflevector(a.lanes(), b.lanes(), 0, 4, 2, 6);
  const Pack::Lanes ab_odd = __builtin_shufflevector(a.lanes(), b.lanes(), 1, 5, 3, 7);
  const Pack::Lanes cd_even = __builtin_shufflevector(c.lanes(), d.lanes(), 0, 4, 2, 6);
  const Pack::Lanes cd_odd = __builtin_shufflevector(c.lanes(), d.lanes(), 1, 5, 3, 7);
  a = Pack(__builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5));
  b = Pack(__builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5));
  c = Pack(__builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7));
  d = Pack(__builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7));
}

}  // namespace grouser
