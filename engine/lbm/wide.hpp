// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>

#ifdef __AVX__
#include <immintrin.h>
#endif

namespace grouser {

#ifdef __AVX512DQ__
inline constexpr std::size_t kWideBytes = 64;
#elif defined(__AVX__)
inline constexpr std::size_t kWideBytes = 32;
#else
inline constexpr std::size_t kWideBytes = 16;
#endif

/// As many numbers as one register holds, with the arithmetic of each of them: laws written for a
/// type T give the same bits for Real and for Wide<Real>.
template <class Real>
struct WideOf;
template <>
struct WideOf<double> {
  using Type = double __attribute__((vector_size(kWideBytes)));
  using Unaligned = double __attribute__((vector_size(kWideBytes), aligned(8), may_alias));
  static constexpr std::size_t kLanes = kWideBytes / sizeof(double);
};
template <>
struct WideOf<float> {
  using Type = float __attribute__((vector_size(kWideBytes)));
  using Unaligned = float __attribute__((vector_size(kWideBytes), aligned(4), may_alias));
  static constexpr std::size_t kLanes = kWideBytes / sizeof(float);
};
template <class Real>
using Wide = typename WideOf<Real>::Type;

/// Read or write from any place, aligned to the number only.
template <class Real>
[[gnu::always_inline]] inline Wide<Real> load_wide(const Real* from) {
  return *reinterpret_cast<const typename WideOf<Real>::Unaligned*>(from);
}
template <class Real>
[[gnu::always_inline]] inline void store_wide(Real* to, Wide<Real> values) {
  *reinterpret_cast<typename WideOf<Real>::Unaligned*>(to) = values;
}

inline double square_root(double a) { return std::sqrt(a); }
inline float square_root(float a) { return std::sqrt(a); }
#ifdef __AVX512DQ__
// The forms with a mask, because GCC 12 warns of its own plain ones.
inline Wide<double> square_root(Wide<double> a) { return _mm512_maskz_sqrt_pd(0xFF, a); }
inline Wide<float> square_root(Wide<float> a) { return _mm512_maskz_sqrt_ps(0xFFFF, a); }
#elif defined(__AVX__)
inline Wide<double> square_root(Wide<double> a) { return _mm256_sqrt_pd(a); }
inline Wide<float> square_root(Wide<float> a) { return _mm256_sqrt_ps(a); }
#else
inline Wide<double> square_root(Wide<double> a) {
  for (std::size_t i = 0; i < 2; ++i) a[i] = std::sqrt(a[i]);
  return a;
}
inline Wide<float> square_root(Wide<float> a) {
  for (std::size_t i = 0; i < 4; ++i) a[i] = std::sqrt(a[i]);
  return a;
}
#endif

}  // namespace grouser
