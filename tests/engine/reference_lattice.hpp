// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/lbm/flow.hpp"

namespace grouser {

/// The lattice-Boltzmann method as textbooks write it: whole populations in two arrays, one cell
/// after another, collision and streaming apart, every collision from its definition. Shares with
/// the engine nothing but the tables of velocities. Periodic ends, half-way walls and obstacles.
template <class Set>
class ReferenceLattice {
 public:
  explicit ReferenceLattice(const FlowSettings& s) : s_(s), n_(s.cells) {
    f_.assign(static_cast<std::size_t>(n_[0] * n_[1] * n_[2]) * kQ, 0.0);
    for (std::int64_t z = 0; z < n_[2]; ++z)
      for (std::int64_t y = 0; y < n_[1]; ++y)
        for (std::int64_t x = 0; x < n_[0]; ++x)
          for (std::size_t i = 0; i < kQ; ++i) at(f_, i, x, y, z) = w(i);
  }

  void set(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z, double beyond_rest) {
    at(f_, i, x, y, z) = w(i) + beyond_rest;
  }
  double get(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return f_[index(i, x, y, z)] - w(i);
  }
  bool is_fluid(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return obstacle_at(x, y, z) < 0;
  }

  void step() {
    std::vector<double> after = f_;
    each([&](std::int64_t x, std::int64_t y, std::int64_t z) {
      collide(&after[index(0, x, y, z)]);
    });
    each([&](std::int64_t x, std::int64_t y, std::int64_t z) {
      for (std::size_t i = 0; i < kQ; ++i) {
        std::int64_t from[3] = {x - c(i, 0), y - c(i, 1), z - c(i, 2)};
        const Vec3* wall = nullptr;
        for (std::size_t a = 0; a < 3 && wall == nullptr; ++a) {
          if (from[a] >= 0 && from[a] < n_[a]) continue;
          if (s_.faces[a][0].kind == FaceKind::kPeriodic)
            from[a] = (from[a] + n_[a]) % n_[a];
          else
            wall = &s_.faces[a][from[a] < 0 ? 0 : 1].velocity_lu;
        }
        if (wall == nullptr) {
          const int o = obstacle_at(from[0], from[1], from[2]);
          if (o >= 0) wall = &s_.obstacles[static_cast<std::size_t>(o)].velocity_lu;
        }
        at(f_, i, x, y, z) = wall == nullptr
                                 ? at(after, i, from[0], from[1], from[2])
                                 : at(after, opposite(i), x, y, z) + 6.0 * w(i) * dot(i, *wall);
      }
    });
  }

 private:
  static constexpr std::size_t kQ = Set::kVelocities;
  static constexpr int kD = Set::kDimensions;
  static double w(std::size_t i) { return Set::kSet.weights[i]; }
  static int c(std::size_t i, int axis) {
    const LatticeVelocity v = Set::kSet.velocities[i];
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
  }
  static double dot(std::size_t i, const Vec3& v) {
    return c(i, 0) * v.x + c(i, 1) * v.y + c(i, 2) * v.z;
  }

  template <class Visit>
  void each(const Visit& visit) const {
    for (std::int64_t z = 0; z < n_[2]; ++z)
      for (std::int64_t y = 0; y < n_[1]; ++y)
        for (std::int64_t x = 0; x < n_[0]; ++x)
          if (is_fluid(x, y, z)) visit(x, y, z);
  }
  std::size_t index(std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * n_[1] + y) * n_[0] + x) * kQ + i;
  }
  double& at(std::vector<double>& f, std::size_t i, std::int64_t x, std::int64_t y,
             std::int64_t z) const {
    return f[index(i, x, y, z)];
  }
  int obstacle_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const Vec3 centre{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    for (std::size_t o = 0; o < s_.obstacles.size(); ++o)
      if (s_.obstacles[o].distance(centre) < 0.0) return static_cast<int>(o);
    return -1;
  }

  void collide(double* f) const {
    const CollisionParameters& p = s_.parameters;
    const Vec3 force = s_.force_lu;
    double density = 0.0;
    Vec3 momentum = 0.5 * force;
    for (std::size_t i = 0; i < kQ; ++i) {
      density += f[i];
      momentum += {c(i, 0) * f[i], c(i, 1) * f[i], c(i, 2) * f[i]};
    }
    const Vec3 u = (1.0 / density) * momentum;
    double equilibrium[kQ];
    double source[kQ];
    for (std::size_t i = 0; i < kQ; ++i) {
      const double cu = dot(i, u);
      equilibrium[i] = w(i) * density * (1.0 + 3.0 * cu + 4.5 * cu * cu - 1.5 * norm2(u));
      source[i] =
          w(i) * (3.0 * (dot(i, force) - grouser::dot(u, force)) + 9.0 * cu * dot(i, force));
    }
    const double time = 3.0 * p.viscosity_lu + 0.5;
    const double even = 1.0 / time;
    const double odd = s_.collision == "bgk" ? even : 1.0 / (p.magic / (time - 0.5) + 0.5);
    double out[kQ];
    if (s_.collision == "bgk" || s_.collision == "trt") {
      for (std::size_t i = 0; i < kQ; ++i) {
        const std::size_t j = opposite(i);
        const auto half = [&](const double* g, double sign) { return 0.5 * (g[i] + sign * g[j]); };
        out[i] = f[i] - even * (half(f, 1) - half(equilibrium, 1)) -
                 odd * (half(f, -1) - half(equilibrium, -1)) + (1 - even / 2) * half(source, 1) +
                 (1 - odd / 2) * half(source, -1);
      }
    } else {
      many_rates(f, equilibrium, source, density, time, odd, out);
    }
    std::copy(out, out + kQ, f);
  }

  // Rates of the stress' deviator, of its trace, of the other even moments and of odd ones.
  void many_rates(const double* f, const double* equilibrium, const double* source, double density,
                  double time, double odd, double* out) const {
    const CollisionParameters& p = s_.parameters;
    double beyond[kQ];
    double stress[3][3] = {};
    for (std::size_t i = 0; i < kQ; ++i) {
      beyond[i] = f[i] - equilibrium[i] + 0.5 * source[i];
      for (int a = 0; a < kD; ++a)
        for (int b = 0; b < kD; ++b) stress[a][b] += c(i, a) * c(i, b) * beyond[i];
    }
    double trace = 0.0;
    for (int a = 0; a < kD; ++a) trace += stress[a][a];
    double size2 = 0.0;
    for (int a = 0; a < kD; ++a)
      for (int b = 0; b < kD; ++b) {
        const double deviator = stress[a][b] - (a == b ? trace / kD : 0.0);
        size2 += deviator * deviator;
      }
    if (s_.collision == "les")
      time = 0.5 * (time + std::sqrt(time * time + 18.0 * std::sqrt(2.0) * p.smagorinsky *
                                                       p.smagorinsky * std::sqrt(size2) / density));
    for (std::size_t i = 0; i < kQ; ++i) {
      double sheared = 0.0;
      double squeezed = 0.0;
      for (int a = 0; a < kD; ++a)
        for (int b = 0; b < kD; ++b) {
          const double hermite = c(i, a) * c(i, b) - (a == b ? 1.0 / 3.0 : 0.0);
          const double isotropic = a == b ? trace / kD : 0.0;
          sheared += 4.5 * w(i) * hermite * (stress[a][b] - isotropic);
          squeezed += 4.5 * w(i) * hermite * isotropic;
        }
      const std::size_t j = opposite(i);
      const double even_part = 0.5 * (beyond[i] + beyond[j]);
      const double odd_part = 0.5 * (beyond[i] - beyond[j]);
      const double other = even_part - sheared - squeezed;
      out[i] = equilibrium[i] + 0.5 * source[i] + (1 - 1 / time) * sheared +
               (1 - p.bulk_rate) * squeezed + (1 - p.higher_rate) * other + (1 - odd) * odd_part;
    }
  }

  FlowSettings s_;
  CellCounts n_;
  std::vector<double> f_;
};

}  // namespace grouser
