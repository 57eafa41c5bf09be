// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <type_traits>
#include <variant>

#include "engine/dem/laws/table.hpp"

namespace grouser {

/// A contact's history as laid out in arrays of numbers: the contact law's, then the rolling law's.
template <class Law, class Rolling>
struct HistoryView {
  template <class History>
  static constexpr std::size_t width_of() {
    if constexpr (std::is_empty_v<History>) return 0;
    return sizeof(History) / sizeof(double);
  }
  static constexpr std::size_t kLaw = width_of<typename Law::History>();
  static constexpr std::size_t kRolling = width_of<typename Rolling::History>();
  static constexpr std::size_t kWidth = kLaw + kRolling;

  static void load(const double* from, typename Law::History& law,
                   typename Rolling::History& rolling) {
    std::memcpy(static_cast<void*>(&law), from, kLaw * sizeof(double));
    if constexpr (kRolling > 0)
      std::memcpy(static_cast<void*>(&rolling), from + kLaw, kRolling * sizeof(double));
  }
  static void store(double* to, const typename Law::History& law,
                    const typename Rolling::History& rolling) {
    std::memcpy(to, &law, kLaw * sizeof(double));
    if constexpr (kRolling > 0) std::memcpy(to + kLaw, &rolling, kRolling * sizeof(double));
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
