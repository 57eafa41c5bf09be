// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "base/vec3.hpp"

namespace grouser {

/// The memory of a history force in bounded room: its kernel t^(-1/2) (1 + (t/T)^(3/4))^-2 as a sum
/// of exponentials whose rates do not depend on T, so that T may change from step to step, and a
/// term that never decays for what lies beyond. Off by under 5e-4 of Basset's kernel for times
/// from half a step to 1e7 steps.
/// Source: kernel Mei and Adrian 1992 (T infinite: Basset 1888). Its spectrum is the jump of the
/// kernel across the negative times; the trapezoidal rule in the logarithm of the rate makes the
/// sum (Beylkin and Monzon 2010).
class HistoryModes {
 public:
  static constexpr std::size_t kModes = 25;  ///< the last does not decay
  using Weights = std::array<double, kModes>;
  using Memory = std::array<Vec3, kModes>;  ///< of one grain [m s-1]

  explicit HistoryModes(double time_step);

  /// Weights for the memory time T [s], infinity for Basset's kernel [s^(-1/2)]. Local.
  Weights weights(double memory_time) const;

  /// The kernel at time t [s] as these weights give it [s^(-1/2)]. Local.
  double kernel(const Weights& weights, double time) const;

  /// Integral of kernel(t - s) a(s) ds over all steps before this one, t in its middle [m
  /// s^(-3/2)]. The half step up to t adds `local_weight()` times its own acceleration. Local.
  Vec3 past(const Weights& weights, const Memory& memory) const;
  double local_weight() const { return local_; }  ///< [s^(1/2)]

  /// Adds a step of constant acceleration to the memory [m s-2]. Local.
  void remember(const Vec3& acceleration, Memory& memory) const;

 private:
  double time_step_;
  double local_;
  std::array<double, kModes> rate_{};
  std::array<double, kModes> half_{};  // decay over half a step
  std::array<double, kModes> step_{};  // decay over a step
  std::array<double, kModes> gain_{};  // what a step of unit acceleration leaves
};

}  // namespace grouser
