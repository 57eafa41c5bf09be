// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

namespace grouser {

/// The names in a text's `{name}`s, each once, in order. A name is letters, digits and _, not
/// beginning with a digit; other braces are plain text. Local.
std::vector<std::string> names_in_braces(const std::string& text);

/// The text with every `{name}` of `values` replaced. What is put in is not looked at again, and
/// nothing is quoted: what goes to a shell is quoted afterwards, word by word. Local.
std::string substitute(const std::string& text, const std::map<std::string, std::string>& values);

}  // namespace grouser
