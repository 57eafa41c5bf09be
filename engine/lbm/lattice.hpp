// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <utility>

/// Marks a lambda that must dissolve into its caller, so that its arrays become registers.
#define GROUSER_INLINE __attribute__((always_inline))

namespace grouser {

/// A discrete velocity [cells per step].
struct LatticeVelocity {
  int x = 0;
  int y = 0;
  int z = 0;
};

/// Square of the speed of sound of every lattice here [cells2 per step2].
inline constexpr double kSoundSpeed2 = 1.0 / 3.0;

/// A set of velocities and their weights. Velocity 0 rests; then come pairs of opposites, so that
/// 2 k + 1 and 2 k + 2 are opposite. All have the moments of a Maxwell distribution up to the third
/// order (fourth order isotropy), which the Navier-Stokes equations at low Mach number need.
/// Source: Qian, d'Humieres, Lallemand 1992; He, Luo 1997 (D3Q27).
template <std::size_t kVelocities>
struct VelocitySet {
  std::array<LatticeVelocity, kVelocities> velocities{};
  std::array<double, kVelocities> weights{};
};

constexpr std::size_t opposite(std::size_t i) { return i == 0 ? 0 : ((i - 1) ^ 1) + 1; }

namespace detail {

/// The rest velocity and the first of each pair, with the weight of each length.
template <std::size_t kPairs>
constexpr VelocitySet<2 * kPairs + 1> mirrored(const std::array<LatticeVelocity, kPairs>& half,
                                               const std::array<double, 4>& weight_of_length2) {
  VelocitySet<2 * kPairs + 1> set;
  set.weights[0] = weight_of_length2[0];
  for (std::size_t k = 0; k < kPairs; ++k) {
    const LatticeVelocity v = half[k];
    const auto length2 = static_cast<std::size_t>(v.x * v.x + v.y * v.y + v.z * v.z);
    set.velocities[2 * k + 1] = v;
    set.velocities[2 * k + 2] = {-v.x, -v.y, -v.z};
    set.weights[2 * k + 1] = set.weights[2 * k + 2] = weight_of_length2[length2];
  }
  return set;
}

}  // namespace detail

struct D2Q9 {
  static constexpr const char* kName = "D2Q9";
  static constexpr int kDimensions = 2;
  static constexpr std::size_t kVelocities = 9;
  static constexpr VelocitySet<9> kSet = detail::mirrored<4>(
      {{{1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, -1, 0}}}, {4.0 / 9, 1.0 / 9, 1.0 / 36, 0.0});
};

struct D3Q15 {
  static constexpr const char* kName = "D3Q15";
  static constexpr int kDimensions = 3;
  static constexpr std::size_t kVelocities = 15;
  static constexpr VelocitySet<15> kSet = detail::mirrored<7>(
      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}}},
      {2.0 / 9, 1.0 / 9, 0.0, 1.0 / 72});
};

struct D3Q19 {
  static constexpr const char* kName = "D3Q19";
  static constexpr int kDimensions = 3;
  static constexpr std::size_t kVelocities = 19;
  static constexpr VelocitySet<19> kSet = detail::mirrored<9>({{{1, 0, 0},
                                                                {0, 1, 0},
                                                                {0, 0, 1},
                                                                {1, 1, 0},
                                                                {1, -1, 0},
                                                                {1, 0, 1},
                                                                {1, 0, -1},
                                                                {0, 1, 1},
                                                                {0, 1, -1}}},
                                                              {1.0 / 3, 1.0 / 18, 1.0 / 36, 0.0});
};

struct D3Q27 {
  static constexpr const char* kName = "D3Q27";
  static constexpr int kDimensions = 3;
  static constexpr std::size_t kVelocities = 27;
  static constexpr VelocitySet<27> kSet =
      detail::mirrored<13>({{{1, 0, 0},
                             {0, 1, 0},
                             {0, 0, 1},
                             {1, 1, 0},
                             {1, -1, 0},
                             {1, 0, 1},
                             {1, 0, -1},
                             {0, 1, 1},
                             {0, 1, -1},
                             {1, 1, 1},
                             {1, 1, -1},
                             {1, -1, 1},
                             {1, -1, -1}}},
                           {8.0 / 27, 2.0 / 27, 1.0 / 54, 1.0 / 216});
};

/// Calls `body` with the constants 0 ... kCount - 1, so that tables are looked up by the compiler.
template <std::size_t kCount, class Body>
[[gnu::always_inline]] constexpr void unroll(const Body& body) {
  [&]<std::size_t... i>(std::index_sequence<i...>) GROUSER_INLINE {
    (body(std::integral_constant<std::size_t, i>{}), ...);
  }
  (std::make_index_sequence<kCount>{});
}

}  // namespace grouser
