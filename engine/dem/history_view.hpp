// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <type_traits>
#include <variant>

#include "engine/dem/laws/table.hpp"

namespace grouser {

/// A contact's history as laid out in arrays of numbers: the contact law's, then the rolling law's.
/// With Pack, the histories of four contacts: first all four of the first number, and so on.
template <class Law, class Rolling, class Real = double>
struct HistoryView {
  using LawHistory = typename Law::template HistoryT<Real>;
  using RollingHistory = typename Rolling::template HistoryT<Real>;

  template <class History>
  static constexpr std::size_t width_of() {
    if constexpr (std::is_empty_v<History>) return 0;
    return sizeof(History) / sizeof(Real);
  }
  static constexpr std::size_t kLaw = width_of<LawHistory>();
  static constexpr std::size_t kRolling = width_of<RollingHistory>();
  static constexpr std::size_t kWidth = kLaw + kRolling;
  static constexpr std::size_t kStride = sizeof(Real) / sizeof(double);

  static void load(const double* from, LawHistory& law, RollingHistory& rolling) {
    std::memcpy(static_cast<void*>(&law), from, kLaw * sizeof(Real));
    if constexpr (kRolling > 0)
      std::memcpy(static_cast<void*>(&rolling), from + kLaw * kStride, kRolling * sizeof(Real));
  }
  static void store(double* to, const LawHistory& law, const RollingHistory& rolling) {
    std::memcpy(to, &law, kLaw * sizeof(Real));
    if constexpr (kRolling > 0) std::memcpy(to + kLaw * kStride, &rolling, kRolling * sizeof(Real));
  }
};

/// Numbers per contact for these laws.
inline std::size_t history_width(const ContactLaw& law, const RollingLaw& rolling) {
  return std::visit(
      [](const auto& a, const auto& b) {
        return HistoryView<std::decay_t<decltype(a)>, std::decay_t<decltype(b)>>::kWidth;
      },
      law, rolling);
}

}  // namespace grouser
