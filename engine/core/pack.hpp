// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/vec3.hpp"

#ifdef __AVX__
#include <immintrin.h>
#endif

namespace grouser {

/// Four numbers side by side, a vector or half a record as it lies in memory. 32 bytes.
using Quad = double __attribute__((vector_size(32)));

/// Reads or writes four numbers aligned to 32 bytes.
inline Quad load_quad(const double* from) {
  using Aliased = double __attribute__((vector_size(32), may_alias));
  return *reinterpret_cast<const Aliased*>(from);
}
inline void store_quad(double* to, Quad quad) {
  using Aliased = double __attribute__((vector_size(32), may_alias));
  *reinterpret_cast<Aliased*>(to) = quad;
}

/// Numbers that are worked on together: eight where a register holds them (AVX-512), else four.
/// Every operation rounds as the same operation on a double does, so code written for a type `Real`
/// gives the same bits with double and with Pack, on any processor.
class Pack {
 public:
#ifdef __AVX512DQ__
  static constexpr std::size_t kLanes = 8;
#else
  static constexpr std::size_t kLanes = 4;
#endif
  using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
  static constexpr std::size_t kAlignment = sizeof(Lanes);

  Pack() = default;
  Pack(double all) : lanes_(all - Lanes{}) {}
  explicit Pack(Lanes lanes) : lanes_(lanes) {}

  /// @param from kLanes numbers, aligned to kAlignment bytes
  static Pack load(const double* from) {
    return Pack(*reinterpret_cast<const AliasedLanes*>(from));
  }
  void store(double* to) const { *reinterpret_cast<AliasedLanes*>(to) = lanes_; }

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
  using AliasedLanes = double __attribute__((vector_size(kLanes * sizeof(double)), may_alias));
  Lanes lanes_{};
};

#ifdef __AVX512DQ__

/// A truth per lane.
class PackMask {
 public:
  PackMask() = default;
  explicit PackMask(__mmask8 bits) : bits_(bits) {}

  /// Bit k is lane k.
  unsigned to_unsigned() const { return bits_; }
  friend PackMask operator!(const PackMask& a) { return PackMask(_knot_mask8(a.bits_)); }
  friend PackMask operator&(const PackMask& a, const PackMask& b) {
    return PackMask(_kand_mask8(a.bits_, b.bits_));
  }
  /// `yes` where true, else `no`.
  Pack choose(const Pack& yes, const Pack& no) const {
    return Pack(_mm512_mask_blend_pd(bits_, no.lanes(), yes.lanes()));
  }

 private:
  __mmask8 bits_{};
};

inline PackMask operator<(const Pack& a, const Pack& b) {
  return PackMask(_mm512_cmp_pd_mask(a.lanes(), b.lanes(), _CMP_LT_OS));
}
inline PackMask operator>(const Pack& a, const Pack& b) {
  return PackMask(_mm512_cmp_pd_mask(a.lanes(), b.lanes(), _CMP_GT_OS));
}
inline PackMask operator>=(const Pack& a, const Pack& b) {
  return PackMask(_mm512_cmp_pd_mask(a.lanes(), b.lanes(), _CMP_GE_OS));
}

// The forms with a mask, because GCC 12 warns of its own plain ones.
inline Pack sqrt(const Pack& a) { return Pack(_mm512_maskz_sqrt_pd(0xFF, a.lanes())); }

#else

/// A truth per lane.
class PackMask {
 public:
  using Bits = std::int64_t __attribute__((vector_size(32)));

  PackMask() = default;
  explicit PackMask(Bits bits) : bits_(bits) {}

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
  /// `yes` where true, else `no`.
  Pack choose(const Pack& yes, const Pack& no) const {
    return Pack(bits_ ? yes.lanes() : no.lanes());
  }

 private:
  Bits bits_{};
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
  return Pack(Quad{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])});
#endif
}

#endif

/// `yes` where the mask is true, else `no`. The same word for one number.
inline Pack select(const PackMask& mask, const Pack& yes, const Pack& no) {
  return mask.choose(yes, no);
}
inline double select(bool mask, double yes, double no) { return mask ? yes : no; }
template <class Mask, class Real>
Vec3T<Real> select(const Mask& mask, const Vec3T<Real>& yes, const Vec3T<Real>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

inline Pack abs(const Pack& a) {
  using Bits = std::int64_t __attribute__((vector_size(sizeof(Pack::Lanes))));
  return Pack(reinterpret_cast<Pack::Lanes>(reinterpret_cast<Bits>(a.lanes()) & INT64_MAX));
}

inline bool any(const PackMask& mask) { return mask.to_unsigned() != 0; }
inline bool any(bool mask) { return mask; }

#ifdef __AVX512DQ__

/// Turns four rows of four numbers into four columns, in each half. Its own inverse.
[[gnu::always_inline]] inline void transpose(Pack::Lanes& a, Pack::Lanes& b, Pack::Lanes& c,
                                             Pack::Lanes& d) {
  const Pack::Lanes ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
  const Pack::Lanes ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  const Pack::Lanes cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
  const Pack::Lanes cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Row k of a Rows and row k + 4 lie in one register.
template <class Row>
[[gnu::always_inline]] inline Pack::Lanes row_of(const Row& row, std::size_t k) {
  return _mm512_maskz_insertf64x4(0xFF, _mm512_castpd256_pd512(row(k)), row(k + 4), 1);
}
[[gnu::always_inline]] inline void store_row(double* to, std::size_t stride, std::size_t k,
                                             Pack::Lanes row) {
  store_quad(to + k * stride, __builtin_shufflevector(row, row, 0, 1, 2, 3));
  store_quad(to + (k + 4) * stride, __builtin_shufflevector(row, row, 4, 5, 6, 7));
}
[[gnu::always_inline]] inline void store_row(double* to, std::size_t stride, std::size_t k,
                                             Pack::Lanes row, Pack::Lanes second) {
  Pack(__builtin_shufflevector(row, second, 0, 1, 2, 3, 8, 9, 10, 11)).store(to + k * stride);
  Pack(__builtin_shufflevector(row, second, 4, 5, 6, 7, 12, 13, 14, 15))
      .store(to + (k + 4) * stride);
}

/// Two Quads on the way of a sum, as they follow one another in memory, aligned to 64 bytes.
class QuadPair {
 public:
  void add(const double* from) { sum_ += Pack::load(from); }
  void store(double* to) const { sum_.store(to); }

 private:
  Pack sum_;
};

#else

/// Turns four rows of four numbers into four columns. Its own inverse.
[[gnu::always_inline]] inline void transpose(Quad& a, Quad& b, Quad& c, Quad& d) {
  const Quad ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Quad ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Quad cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

template <class Row>
[[gnu::always_inline]] inline Quad row_of(const Row& row, std::size_t k) {
  return row(k);
}
[[gnu::always_inline]] inline void store_row(double* to, std::size_t stride, std::size_t k,
                                             Quad row) {
  store_quad(to + k * stride, row);
}
[[gnu::always_inline]] inline void store_row(double* to, std::size_t stride, std::size_t k,
                                             Quad row, Quad second) {
  store_quad(to + k * stride, row);
  store_quad(to + k * stride + 4, second);
}

class QuadPair {
 public:
  void add(const double* from) {
    first_ += load_quad(from);
    second_ += load_quad(from + 4);
  }
  void store(double* to) const {
    store_quad(to, first_);
    store_quad(to + 4, second_);
  }

 private:
  Quad first_{};
  Quad second_{};
};

#endif

/// The vectors that row(0) ... row(kLanes - 1), each a Quad, hold in their first three numbers.
/// @param fourth the fourth numbers; null: not wanted
template <class Row>
[[gnu::always_inline]] inline Vec3T<Pack> columns_of(const Row& row, Pack* fourth = nullptr) {
  Pack::Lanes a = row_of(row, 0);
  Pack::Lanes b = row_of(row, 1);
  Pack::Lanes c = row_of(row, 2);
  Pack::Lanes d = row_of(row, 3);
  transpose(a, b, c, d);
  if (fourth != nullptr) *fourth = Pack(d);
  return {Pack(a), Pack(b), Pack(c)};
}

/// The same of row(k) - minus(k).
template <class Row, class Minus>
[[gnu::always_inline]] inline Vec3T<Pack> columns_of_difference(const Row& row,
                                                                const Minus& minus) {
  Pack::Lanes a = row_of(row, 0) - row_of(minus, 0);
  Pack::Lanes b = row_of(row, 1) - row_of(minus, 1);
  Pack::Lanes c = row_of(row, 2) - row_of(minus, 2);
  Pack::Lanes d = row_of(row, 3) - row_of(minus, 3);
  transpose(a, b, c, d);
  return {Pack(a), Pack(b), Pack(c)};
}

/// Vectors turned into rows, one for each lane, with a fourth number behind each.
class Rows {
 public:
  [[gnu::always_inline]] explicit Rows(const Vec3T<Pack>& v, const Pack& fourth = Pack())
      : a_(v.x.lanes()), b_(v.y.lanes()), c_(v.z.lanes()), d_(fourth.lanes()) {
    transpose(a_, b_, c_, d_);
  }
  [[gnu::always_inline]] Rows operator-() const { return Rows(-a_, -b_, -c_, -d_); }

  /// Writes each lane's row to to + lane x stride (aligned to 32 bytes).
  [[gnu::always_inline]] void store(double* to, std::size_t stride) const {
    store_row(to, stride, 0, a_);
    store_row(to, stride, 1, b_);
    store_row(to, stride, 2, c_);
    store_row(to, stride, 3, d_);
  }
  /// The same with the row of `second` behind it (aligned to 64 bytes).
  [[gnu::always_inline]] void store(const Rows& second, double* to, std::size_t stride) const {
    store_row(to, stride, 0, a_, second.a_);
    store_row(to, stride, 1, b_, second.b_);
    store_row(to, stride, 2, c_, second.c_);
    store_row(to, stride, 3, d_, second.d_);
  }

 private:
  using Lanes = Pack::Lanes;
  Rows(Lanes a, Lanes b, Lanes c, Lanes d) : a_(a), b_(b), c_(c), d_(d) {}
  Lanes a_, b_, c_, d_;
};

}  // namespace grouser
