// SPDX-License-Identifier: BSD-3-Clause
#include "base/substitution.hpp"

#include <algorithm>

namespace grouser {
namespace {

constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
constexpr const char* kLettersAndDigits =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";

// The name whose `{` stands at `at`, or "".
std::string name_at(const std::string& text, std::size_t at) {
  const std::size_t from = at + 1;
  if (text[at] != '{' || text.find_first_of(kLetters, from) != from) return "";
  const std::size_t to = text.find_first_not_of(kLettersAndDigits, from);
  return to != std::string::npos && text[to] == '}' ? text.substr(from, to - from) : "";
}

}  // namespace

std::vector<std::string> names_in_braces(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::string name = name_at(text, at);
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  return names;
}

std::string substitute(const std::string& text, const std::map<std::string, std::string>& values) {
  std::string filled;
  for (std::size_t at = 0; at < text.size();) {
    const std::string name = name_at(text, at);
    const auto value = name.empty() ? values.end() : values.find(name);
    if (value == values.end()) {
      filled += text[at++];
    } else {
      filled += value->second;
      at += name.size() + 2;
    }
  }
  return filled;
}

}  // namespace grouser
