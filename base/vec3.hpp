// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace grouser {

/// A vector of three Cartesian components (x forward, y across, z up).
/// @tparam Real  double, or Pack for as many vectors as it has lanes
template <class Real>
struct Vec3T {
  Real x{};
  Real y{};
  Real z{};

  Vec3T& operator+=(const Vec3T& o) {
    x += o.x;
    y += o.y;
    z += o.z;
    return *this;
  }
  Vec3T& operator-=(const Vec3T& o) {
    x -= o.x;
    y -= o.y;
    z -= o.z;
    return *this;
  }
  Vec3T& operator*=(const Real& s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
  friend Vec3T operator+(Vec3T a, const Vec3T& b) { return a += b; }
  friend Vec3T operator-(Vec3T a, const Vec3T& b) { return a -= b; }
  friend Vec3T operator-(const Vec3T& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3T operator*(const Real& s, Vec3T a) { return a *= s; }
  friend Vec3T operator*(Vec3T a, const Real& s) { return a *= s; }
  friend bool operator==(const Vec3T& a, const Vec3T& b) = default;
};

using Vec3 = Vec3T<double>;

template <class Real>
Real dot(const Vec3T<Real>& a, const Vec3T<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
Vec3T<Real> cross(const Vec3T<Real>& a, const Vec3T<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
Real norm2(const Vec3T<Real>& a) {
  return dot(a, a);
}
inline double norm(const Vec3& a) { return std::sqrt(norm2(a)); }

}  // namespace grouser
