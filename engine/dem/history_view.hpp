// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>
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

  [[gnu::always_inline]] static void load(const double* from, LawHistory& law,
                                          RollingHistory& rolling) {
    copy_in<kLaw>(from, &law);
    copy_in<kRolling>(from + kLaw * kStride, &rolling);
  }
  [[gnu::always_inline]] static void store(double* to, const LawHistory& law,
                                           const RollingHistory& rolling) {
    copy_out<kLaw>(&law, to);
    copy_out<kRolling>(&rolling, to + kLaw * kStride);
  }

  /// Stores zeros where the mask is false.
  template <class Mask>
  [[gnu::always_inline]] static void store_where(const Mask& mask, double* to, LawHistory law,
                                                 RollingHistory rolling) {
    clear_where_not<kLaw>(mask, &law);
    clear_where_not<kRolling>(mask, &rolling);
    store(to, law, rolling);
  }

 private:
  // Number by number, so that histories stay in registers.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void copy_in(const double* from, void* history) {
    auto* const to = static_cast<Real*>(history);
    [&]<std::size_t... k>(std::index_sequence<k...>) { ((to[k] = read(from + k * kStride)), ...); }
    (std::make_index_sequence<kCount>());
  }
  template <std::size_t kCount>
  [[gnu::always_inline]] static void copy_out(const void* history, double* to) {
    const auto* const from = static_cast<const Real*>(history);
    [&]<std::size_t... k>(std::index_sequence<k...>) { (write(from[k], to + k * kStride), ...); }
    (std::make_index_sequence<kCount>());
  }
  template <std::size_t kCount, class Mask>
  [[gnu::always_inline]] static void clear_where_not(const Mask& mask, void* history) {
    auto* const numbers = static_cast<Real*>(history);
    [&]<std::size_t... k>(std::index_sequence<k...>) {
      ((numbers[k] = select(mask, numbers[k], Real(0.0))), ...);
    }
    (std::make_index_sequence<kCount>());
  }
  static Real read(const double* from) {
    if constexpr (std::is_same_v<Real, double>)
      return *from;
    else
      return Real::load(from);
  }
  static void write(const Real& value, double* to) {
    if constexpr (std::is_same_v<Real, double>)
      *to = value;
    else
      value.store(to);
  }
};

/// What a contact with this history, as laid out in an array, holds, rolling included.
/// @param radius effective radius [m]. Local.
inline ContactStore store_of(const ContactLaw& law, const RollingLaw& rolling, const double* values,
                             double radius) {
  return std::visit(
      [&](const auto& contact, const auto& turning) {
        using View = HistoryView<std::decay_t<decltype(contact)>, std::decay_t<decltype(turning)>>;
        typename View::LawHistory contact_history;
        typename View::RollingHistory rolling_history;
        View::load(values, contact_history, rolling_history);
        ContactStore store = contact.store_of(contact_history, radius);
        store.energy += turning.energy_of(rolling_history, store, radius);
        return store;
      },
      law, rolling);
}

/// Numbers per contact for these laws.
inline std::size_t history_width(const ContactLaw& law, const RollingLaw& rolling) {
  return std::visit(
      [](const auto& a, const auto& b) {
        return HistoryView<std::decay_t<decltype(a)>, std::decay_t<decltype(b)>>::kWidth;
      },
      law, rolling);
}

}  // namespace grouser
