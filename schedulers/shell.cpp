// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/shell.hpp"

#include <sstream>
#include <stdexcept>

namespace grouser {

std::string shell_quote(const std::string& text) {
  if (text.find('\0') != std::string::npos)
    throw std::invalid_argument("a shell word cannot hold a NUL character");
  std::string quoted = "'";
  for (const char c : text) {
    // Inside single quotes everything is literal but the quote itself.
    if (c == '\'')
      quoted += "'\\''";
    else
      quoted += c;
  }
  return quoted + "'";
}

std::string shell_join(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_quote(word);
  return line;
}

std::vector<std::string> split_words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::string fill(const std::string& text, const std::map<std::string, std::string>& values) {
  std::string filled;
  std::size_t at = 0;
  while (at < text.size()) {
    const auto close = text[at] == '@' ? text.find('@', at + 1) : std::string::npos;
    const auto value = close == std::string::npos
                           ? values.end()
                           : values.find(text.substr(at + 1, close - at - 1));
    if (value == values.end()) {
      filled += text[at++];
    } else {
      filled += value->second;
      at = close + 1;
    }
  }
  return filled;
}

}  // namespace grouser
