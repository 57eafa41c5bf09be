// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <sstream>
#include <string>
#include <vector>

namespace grouser {

/// Lines of `text` that are not empty. Local.
inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

/// `line` cut at every `separator`; empty parts are kept. Local.
inline std::vector<std::string> cut(const std::string& line, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : line) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// Whether one of `parts` occurs in `text`. Local.
inline bool contains_any(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts)
    if (text.find(part) != std::string::npos) return true;
  return false;
}

/// `text` on one line, blanks at the ends cut off, at most `limit` characters. Local.
inline std::string one_line(const std::string& text, std::size_t limit = 300) {
  std::string line;
  for (const std::string& part : lines_of(text)) line += (line.empty() ? "" : " / ") + part;
  if (line.size() > limit) line.resize(limit);
  return line;
}

}  // namespace grouser
