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

/// Changes the sign of those numbers whose `signs` is -0.0.
inline Quad flip_signs(Quad a, Quad signs) {
  using Bits = std::int64_t __attribute__((vector_size(32)));
  return reinterpret_cast<Quad>(reinterpret_cast<Bits>(a) ^ reinterpret_cast<Bits>(signs));
}

/// Four numbers that are worked on together. Every operation rounds as the same operation on a
/// double does, so code written for a type `Real` gives the same bits with double and with Pack, on
/// any processor.
class Pack {
 public:
  static constexpr std::size_t kLanes = 4;

  Pack() = default;
  Pack(double all) : lanes_{all, all, all, all} {}
  explicit Pack(Quad lanes) : lanes_(lanes) {}

  /// @param from four numbers, aligned to 32 bytes
  static Pack load(const double* from) { return Pack(load_quad(from)); }
  void store(double* to) const { store_quad(to, lanes_); }

  Quad lanes() const { return lanes_; }
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
  Quad lanes_{};
};

/// A truth per lane.
class PackMask {
 public:
  using Bits = std::int64_t __attribute__((vector_size(32)));

  explicit PackMask(Bits bits) : bits_(bits) {}

  Bits bits() const { return bits_; }
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
  Bits bits_;
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

/// Turns four rows of four numbers into four columns. Its own inverse.
inline void transpose(Quad& a, Quad& b, Quad& c, Quad& d) {
  const Quad ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Quad ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Quad cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

/// The vectors that row(0) ... row(3) hold in their first three numbers.
template <class Row>
Vec3T<Pack> columns_of(const Row& row) {
  Quad a = row(0);
  Quad b = row(1);
  Quad c = row(2);
  Quad d = row(3);
  transpose(a, b, c, d);
  return {Pack(a), Pack(b), Pack(c)};
}

/// Writes each lane's vector, and a zero behind it, to to + lane x stride (aligned to 32 bytes).
inline void store_rows(const Vec3T<Pack>& v, double* to, std::size_t stride) {
  Quad a = v.x.lanes();
  Quad b = v.y.lanes();
  Quad c = v.z.lanes();
  Quad d{};
  transpose(a, b, c, d);
  store_quad(to, a);
  store_quad(to + stride, b);
  store_quad(to + 2 * stride, c);
  store_quad(to + 3 * stride, d);
}

}  // namespace grouser
