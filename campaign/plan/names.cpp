// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/plan/names.hpp"

#include <algorithm>
#include <string_view>

namespace grouser {
namespace {

constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
constexpr std::string_view kDigits = "0123456789";

bool consists_of(const std::string& text, std::string_view others) {
  return std::all_of(text.begin(), text.end(), [&](char c) {
    return kLetters.find(c) != std::string_view::npos ||
           kDigits.find(c) != std::string_view::npos || others.find(c) != std::string_view::npos;
  });
}

bool has_name_length(const std::string& text) { return !text.empty() && text.size() <= 64; }

}  // namespace

bool is_campaign_name(const std::string& text) {
  return has_name_length(text) && consists_of(text, "_-") && text.front() != '-';
}

bool is_label(const std::string& text) {
  return has_name_length(text) && consists_of(text, "._+-") && text.front() != '-' &&
         text.front() != '.';
}

bool is_batch_name(const std::string& text) {
  return text.size() <= 128 && consists_of(text, "._+@:/=-") &&
         (text.empty() || text.front() != '-');
}

bool is_memory(const std::string& text) {
  const auto unit = text.find_first_not_of(kDigits);
  if (text.empty()) return true;
  if (unit == 0 || text.size() > 18) return false;
  if (unit == std::string::npos) return true;
  const std::string suffix = text.substr(unit);
  for (const char* known : {"K", "M", "G", "T", "KB", "MB", "GB", "TB", "kb", "mb", "gb", "tb"})
    if (suffix == known) return true;
  return false;
}

bool is_one_line(const std::string& text) {
  return std::none_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7f;
  });
}

}  // namespace grouser
