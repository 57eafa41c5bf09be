// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/recordings/settings.hpp"

namespace grouser::diagnosis {
namespace {

constexpr bool tables_are_in_order() {
  for (std::size_t i = 0; i < kSettingCount; ++i)
    if (index_of(kSettings[i].id) != i) return false;
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    if (static_cast<std::size_t>(kSignals[i].id) != i) return false;
  return true;
}
static_assert(tables_are_in_order(), "tables must follow their enumerators");

}  // namespace

std::optional<Setting> find_setting(const std::string& name) {
  for (const SettingEntry& entry : kSettings)
    if (name == entry.name) return entry.id;
  return std::nullopt;
}

std::optional<Signal> find_signal(const std::string& name) {
  for (const SignalEntry& entry : kSignals)
    if (name == entry.name) return entry.id;
  return std::nullopt;
}

}  // namespace grouser::diagnosis
