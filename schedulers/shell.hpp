// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

namespace grouser {

/// `text` as one word of a POSIX shell, whatever it contains. @throws std::invalid_argument when it
/// holds a NUL, which no argument can. Local.
std::string shell_quote(const std::string& text);

/// The words quoted and joined by blanks. Local.
std::string shell_join(const std::vector<std::string>& words);

/// The words of a line, split at blanks; nothing is unquoted or expanded. Local.
std::vector<std::string> split_words(const std::string& line);

/// `text` with every `@NAME@` of `values` replaced; what is put in is not looked at again, and
/// other
/// @ signs stay. Local.
std::string fill(const std::string& text, const std::map<std::string, std::string>& values);

}  // namespace grouser
