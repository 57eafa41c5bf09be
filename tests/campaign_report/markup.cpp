// SPDX-License-Identifier: BSD-3-Clause
#include "markup.hpp"

#include <regex>
#include <vector>

namespace grouser::markup {
namespace {

/// Whether every & of `text` begins a known reference.
bool references_are_sound(const std::string& text) {
  static const std::regex kReference("&(amp|lt|gt|quot|#[0-9]+);");
  for (std::size_t at = text.find('&'); at != std::string::npos; at = text.find('&', at + 1))
    if (!std::regex_search(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), kReference,
                           std::regex_constants::match_continuous))
      return false;
  return true;
}

/// Checks `<name attribute="value" ...>` without its brackets; `name` is set.
bool tag_is_sound(const std::string& tag, std::string& name) {
  static const std::regex kTag(
      "([a-zA-Z][a-zA-Z0-9]*)((\\s+[a-zA-Z][a-zA-Z-]*=\"[^\"<]*\")*)\\s*/?");
  std::smatch match;
  if (!std::regex_match(tag, match, kTag)) return false;
  name = match[1];
  return references_are_sound(match[2]);
}

}  // namespace

std::string first_fault(const std::string& html) {
  std::vector<std::string> open;
  std::size_t at = 0;
  while (at < html.size()) {
    const std::size_t from = html.find('<', at);
    const std::string text = html.substr(at, from == std::string::npos ? from : from - at);
    const bool is_style = !open.empty() && open.back() == "style";
    if (!is_style && (text.find('>') != std::string::npos || !references_are_sound(text)))
      return "raw character in text: " + text.substr(0, 80);
    if (from == std::string::npos) break;
    const std::size_t to = html.find('>', from);
    if (to == std::string::npos) return "tag without end";
    std::string tag = html.substr(from + 1, to - from - 1);
    at = to + 1;
    if (tag == "!DOCTYPE html") continue;
    if (tag[0] == '/') {
      if (open.empty() || open.back() != tag.substr(1))
        return "unexpected </" + tag.substr(1) + ">";
      open.pop_back();
      continue;
    }
    std::string name;
    if (!tag_is_sound(tag, name)) return "bad tag <" + tag.substr(0, 120) + ">";
    if (tag.back() != '/') open.push_back(name);
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

}  // namespace grouser::markup
