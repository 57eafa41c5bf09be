// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <variant>

#include "base/vec3.hpp"
#include "engine/lbm/lattice.hpp"
#include "engine/lbm/wide.hpp"

namespace grouser {

/// What decides how populations relax, all in lattice units (suffix _lu: cells, steps, and the
/// density of the fluid at rest as 1).
struct CollisionParameters {
  double viscosity_lu = 1.0 / 6.0;  ///< kinematic, > 0
  /// (1/e - 1/2) (1/o - 1/2) of the rates e of even and o of odd moments: 3/16 puts a half-way wall
  /// exactly half-way in a channel (Ginzburg, Verhaeghe, d'Humieres 2008). BGK has no choice.
  double magic = 3.0 / 16.0;
  double bulk_rate = 1.0;    ///< of the trace of the stress, 0 to 2; MRT only
  double higher_rate = 1.0;  ///< of even moments beyond the stress, 0 to 2; MRT only
  double smagorinsky = 0.0;  ///< constant C, 0.1 to 0.2 is usual; LES only
};

/// 3 viscosity + 1/2: must be over 1/2.
constexpr double relaxation_time(double viscosity_lu) { return 3.0 * viscosity_lu + 0.5; }

namespace detail {

/// The component of v along the first velocity of pair k, which starts with a positive component.
template <class Set, std::size_t k, class T>
[[gnu::always_inline]] inline T along(const Vec3T<T>& v) {
  constexpr LatticeVelocity c = Set::kSet.velocities[2 * k + 1];
  static_assert(c.x == 1 || (c.x == 0 && (c.y == 1 || (c.y == 0 && c.z == 1))));
  if constexpr (c.x == 1) {
    T sum = v.x;
    if constexpr (c.y == 1) sum = sum + v.y;
    if constexpr (c.y == -1) sum = sum - v.y;
    if constexpr (c.z == 1) sum = sum + v.z;
    if constexpr (c.z == -1) sum = sum - v.z;
    return sum;
  } else if constexpr (c.y == 1) {
    T sum = v.y;
    if constexpr (c.z == 1) sum = sum + v.z;
    if constexpr (c.z == -1) sum = sum - v.z;
    return sum;
  } else {
    return v.z;
  }
}

/// The sum of values[k] weighted by products c_a c_b, a and b below three, over pairs of
/// velocities. Pair a is the one along axis a, so that sums over squares start with it.
template <class Set, std::size_t a, std::size_t b, class T>
[[gnu::always_inline]] inline T second_sum(const T* values) {
  T sum{};
  if constexpr (a == b && a < Set::kDimensions) sum = values[a];
  unroll<Set::kVelocities / 2>([&](auto k) GROUSER_INLINE {
    if constexpr (k >= Set::kDimensions) {
      constexpr LatticeVelocity c = Set::kSet.velocities[2 * k + 1];
      constexpr int v[3] = {c.x, c.y, c.z};
      if constexpr (v[a] * v[b] == 1) sum = sum + values[k];
      if constexpr (v[a] * v[b] == -1) sum = sum - values[k];
    }
  });
  return sum;
}

template <class Set, std::size_t a, class T>
[[gnu::always_inline]] inline T first_sum(const T* values) {
  T sum{};
  if constexpr (a < Set::kDimensions) sum = values[a];
  unroll<Set::kVelocities / 2>([&](auto k) GROUSER_INLINE {
    if constexpr (k >= Set::kDimensions) {
      constexpr LatticeVelocity c = Set::kSet.velocities[2 * k + 1];
      constexpr int v[3] = {c.x, c.y, c.z};
      if constexpr (v[a] == 1) sum = sum + values[k];
      if constexpr (v[a] == -1) sum = sum - values[k];
    }
  });
  return sum;
}

}  // namespace detail

/// A symmetric tensor.
template <class T>
struct Symmetric {
  T xx{}, yy{}, zz{}, xy{}, xz{}, yz{};
};

/// The hydrodynamic moments of the populations of one node, or of as many as T has lanes.
/// Populations are zero-centred: each is kept without the weight it has in the fluid at rest, which
/// saves digits that single precision needs (Skordos 1993).
template <class Set, class T>
struct NodeMoments {
  static constexpr std::size_t kPairs = Set::kVelocities / 2;
  T even[kPairs];  ///< f(2k+1) + f(2k+2)
  T odd[kPairs];   ///< f(2k+1) - f(2k+2)
  T excess;        ///< density - 1
  T density;
  Vec3T<T> momentum;  ///< with half of the force of this step (Guo, Zheng, Shi 2002)
  Vec3T<T> velocity;  ///< momentum / density
};

template <bool kForced, class Set, class T, class Real>
[[gnu::always_inline]] inline NodeMoments<Set, T> moments_of(const T* f, const Vec3T<Real>& force) {
  NodeMoments<Set, T> m;
  m.excess = f[0];
  unroll<Set::kVelocities / 2>([&](auto k) GROUSER_INLINE {
    m.even[k] = f[2 * k + 1] + f[2 * k + 2];
    m.odd[k] = f[2 * k + 1] - f[2 * k + 2];
    m.excess = m.excess + m.even[k];
  });
  m.momentum = {detail::first_sum<Set, 0>(m.odd), detail::first_sum<Set, 1>(m.odd), T{}};
  if constexpr (Set::kDimensions == 3) m.momentum.z = detail::first_sum<Set, 2>(m.odd);
  if constexpr (kForced) {
    m.momentum.x = m.momentum.x + Real(0.5) * force.x;
    m.momentum.y = m.momentum.y + Real(0.5) * force.y;
    m.momentum.z = m.momentum.z + Real(0.5) * force.z;
  }
  m.density = m.excess + Real(1);
  const T inverse = Real(1) / m.density;
  m.velocity = inverse * m.momentum;
  return m;
}

/// Two rates: even moments relax with one, odd moments with the other. BGK is both the same
/// (Bhatnagar, Gross, Krook 1954), TRT puts the odd rate where walls are exact (Ginzburg 2008).
/// The equilibrium is the second order one, w (d + 3 c.j + rho (9/2 (c.u)^2 - 3/2 u^2)), d the
/// excess of density; the body force that of Guo, Zheng, Shi 2002, with each part relaxed at its
/// own rate.
template <class Real>
struct TwoRates {
  Real even{1};
  Real odd{1};

  static TwoRates bgk(const CollisionParameters& p) {
    const auto rate = static_cast<Real>(1.0 / relaxation_time(p.viscosity_lu));
    return {rate, rate};
  }
  static TwoRates trt(const CollisionParameters& p) {
    const double time = relaxation_time(p.viscosity_lu);
    return {static_cast<Real>(1.0 / time), static_cast<Real>(1.0 / (p.magic / (time - 0.5) + 0.5))};
  }

  /// Replaces what arrives at a node by what leaves it.
  /// @param f      populations, changed in place
  /// @param force  body force density; not looked at unless kForced
  template <class Set, bool kForced, class T>
  [[gnu::always_inline]] void collide(T* f, const Vec3T<Real>& force) const {
    const NodeMoments<Set, T> m = moments_of<kForced, Set>(f, force);
    relax<Set, kForced>(f, m, force, [](auto) GROUSER_INLINE { return NoExtra{}; });
  }

  struct NoExtra {};

  /// The same with something added to the even part of every pair: extra(k) is it for pair k, and
  /// extra(kPairs) that of the population at rest.
  /// @param force one for all nodes or, as a vector of T, one for each
  template <class Set, bool kForced, class T, class Force, class Extra>
  [[gnu::always_inline]] void relax(T* f, const NodeMoments<Set, T>& m, const Force& force,
                                    const Extra& extra) const {
    constexpr std::size_t kPairs = Set::kVelocities / 2;
    constexpr const auto& weights = Set::kSet.weights;
    const Real forced_even = Real(1) - Real(0.5) * even;
    const Real forced_odd = Real(1) - Real(0.5) * odd;
    T isotropic = even * (m.excess - Real(1.5) * dot(m.momentum, m.velocity));
    if constexpr (kForced) {
      const T power = force.x * m.velocity.x + force.y * m.velocity.y + force.z * m.velocity.z;
      isotropic = isotropic - (Real(3) * forced_even) * power;
    }
    const auto plus = [](const T& a, const auto& b) GROUSER_INLINE {
      if constexpr (std::is_same_v<std::decay_t<decltype(b)>, NoExtra>)
        return a;
      else
        return a + b;
    };
    const Real keep_even = Real(0.5) * (Real(1) - even);
    const Real keep_odd = Real(0.5) * (Real(1) - odd);
    unroll<kPairs>([&](auto k) GROUSER_INLINE {
      constexpr auto weight = static_cast<Real>(weights[2 * k + 1]);
      const T velocity = detail::along<Set, k>(m.velocity);
      const T momentum = detail::along<Set, k>(m.momentum);
      T stretch = (Real(4.5) * weight * even) * momentum;
      T straight = keep_odd * m.odd[k] + (Real(3) * weight * odd) * momentum;
      if constexpr (kForced) {
        const auto push = weight * detail::along<Set, k>(force);
        stretch = stretch + Real(9) * forced_even * push;
        straight = straight + Real(3) * forced_odd * push;
      }
      T level = keep_even * m.even[k] + weight * isotropic;
      level = plus(level + stretch * velocity, extra(k));
      f[2 * k + 1] = level + straight;
      f[2 * k + 2] = level - straight;
    });
    constexpr auto rest = static_cast<Real>(weights[0]);
    f[0] = plus((Real(1) - even) * f[0] + rest * isotropic,
                extra(std::integral_constant<std::size_t, kPairs>{}));
  }
};

/// Four rates in the Hermite moments of the lattice: shear stress, its trace, the other even
/// moments, and odd moments. The other even ones at rate 1 are forgotten at once, which damps what
/// grows first at small viscosities. With C > 0 the shear rate is that of a large eddy simulation:
/// the eddy viscosity C^2 |S| of Smagorinsky 1963, |S| from the stress of the node itself (Hou,
/// Sterling, Chen, Doolen 1996).
/// Source: Shan, Chen 2007; Latt, Chopard 2006.
template <class Real, bool kEddies>
struct ManyRates {
  TwoRates<Real> others;
  Real shear{1};
  Real bulk{1};
  Real eddies{0};  ///< 18 sqrt(2) C^2

  static ManyRates from_parameters(const CollisionParameters& p) {
    ManyRates made;
    made.others = TwoRates<Real>::trt(p);
    made.others.even = static_cast<Real>(p.higher_rate);
    made.shear = static_cast<Real>(1.0 / relaxation_time(p.viscosity_lu));
    made.bulk = static_cast<Real>(p.bulk_rate);
    made.eddies = static_cast<Real>(18.0 * std::sqrt(2.0) * p.smagorinsky * p.smagorinsky);
    return made;
  }

  template <class Set, bool kForced, class T>
  [[gnu::always_inline]] void collide(T* f, const Vec3T<Real>& force) const {
    const NodeMoments<Set, T> m = moments_of<kForced, Set>(f, force);
    Symmetric<T> s = stress<Set, kForced>(m, force);
    constexpr auto share = static_cast<Real>(1.0 / Set::kDimensions);
    T trace = s.xx + s.yy;
    if constexpr (Set::kDimensions == 3) trace = trace + s.zz;
    const T mean = share * trace;
    s.xx = s.xx - mean;
    s.yy = s.yy - mean;
    if constexpr (Set::kDimensions == 3) s.zz = s.zz - mean;
    // What the other rate takes too much from the stress is given back.
    const T sheared = others.even - shear_rate<Set>(s, m.density);
    const T squeezed = (others.even - bulk) * mean;
    s = {sheared * s.xx + squeezed,
         sheared * s.yy + squeezed,
         sheared * s.zz + squeezed,
         sheared * s.xy,
         sheared * s.xz,
         sheared * s.yz};
    const T third = Real(1.0 / 3.0) * ((others.even - bulk) * trace);
    others.template relax<Set, kForced>(f, m, force, [&](auto k) GROUSER_INLINE {
      if constexpr (k == Set::kVelocities / 2) {
        constexpr auto weight = static_cast<Real>(4.5 * Set::kSet.weights[0]);
        return -weight * third;
      } else {
        constexpr auto weight = static_cast<Real>(4.5 * Set::kSet.weights[2 * k + 1]);
        return weight * (quadratic<Set, k>(s) - third);
      }
    });
  }

 private:
  /// The part of the momentum flux beyond equilibrium, force included.
  template <class Set, bool kForced, class T>
  [[gnu::always_inline]] static Symmetric<T> stress(const NodeMoments<Set, T>& m,
                                                    const Vec3T<Real>& force) {
    const T pressure = Real(kSoundSpeed2) * m.excess;
    const Vec3T<T>& j = m.momentum;
    const Vec3T<T>& u = m.velocity;
    Symmetric<T> s;
    s.xx = detail::second_sum<Set, 0, 0>(m.even) - pressure - j.x * u.x;
    s.yy = detail::second_sum<Set, 1, 1>(m.even) - pressure - j.y * u.y;
    s.xy = detail::second_sum<Set, 0, 1>(m.even) - j.x * u.y;
    if constexpr (Set::kDimensions == 3) {
      s.zz = detail::second_sum<Set, 2, 2>(m.even) - pressure - j.z * u.z;
      s.xz = detail::second_sum<Set, 0, 2>(m.even) - j.x * u.z;
      s.yz = detail::second_sum<Set, 1, 2>(m.even) - j.y * u.z;
    }
    if constexpr (kForced) {
      s.xx = s.xx + force.x * u.x;
      s.yy = s.yy + force.y * u.y;
      s.xy = s.xy + Real(0.5) * (force.x * u.y + force.y * u.x);
      if constexpr (Set::kDimensions == 3) {
        s.zz = s.zz + force.z * u.z;
        s.xz = s.xz + Real(0.5) * (force.x * u.z + force.z * u.x);
        s.yz = s.yz + Real(0.5) * (force.y * u.z + force.z * u.y);
      }
    }
    return s;
  }

  template <class Set, class T>
  [[gnu::always_inline]] T shear_rate(const Symmetric<T>& s, const T& density) const {
    if constexpr (!kEddies) {
      return T{} + shear;
    } else {
      const T size2 = s.xx * s.xx + s.yy * s.yy + s.zz * s.zz +
                      Real(2) * (s.xy * s.xy + s.xz * s.xz + s.yz * s.yz);
      const Real time = Real(1) / shear;
      const T more = eddies * square_root(size2) / density;
      return Real(2) / (time + square_root(time * time + more));
    }
  }

  /// c.S.c of the first velocity of pair k.
  template <class Set, std::size_t k, class T>
  [[gnu::always_inline]] static T quadratic(const Symmetric<T>& s) {
    constexpr LatticeVelocity c = Set::kSet.velocities[2 * k + 1];
    T sum = c.x != 0 ? s.xx : c.y != 0 ? s.yy : s.zz;
    if constexpr (c.x != 0 && c.y != 0) sum = sum + s.yy;
    if constexpr ((c.x != 0 || c.y != 0) && c.z != 0) sum = sum + s.zz;
    if constexpr (c.x * c.y != 0) sum = sum + Real(2 * c.x * c.y) * s.xy;
    if constexpr (c.x * c.z != 0) sum = sum + Real(2 * c.x * c.z) * s.xz;
    if constexpr (c.y * c.z != 0) sum = sum + Real(2 * c.y * c.z) * s.yz;
    return sum;
  }
};

/// The collisions a case can name. A new one is its type here and its word in make_collision;
/// sweeps are templates over it.
template <class Real>
using Collision = std::variant<TwoRates<Real>, ManyRates<Real, false>, ManyRates<Real, true>>;

inline constexpr std::array<const char*, 4> kCollisions = {"bgk", "trt", "mrt", "les"};

/// The collision called `name`, one of kCollisions. Local.
template <class Real>
Collision<Real> make_collision(const std::string& name, const CollisionParameters& p) {
  if (name == "bgk") return TwoRates<Real>::bgk(p);
  if (name == "mrt") return ManyRates<Real, false>::from_parameters(p);
  if (name == "les") return ManyRates<Real, true>::from_parameters(p);
  return TwoRates<Real>::trt(p);
}

}  // namespace grouser
