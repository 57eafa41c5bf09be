// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace grouser {

/// One option of a verb, as --help has it.
struct OptionText {
  std::vector<std::string> names;  ///< with their dashes; empty for an argument by position
  std::string argument;            ///< what it is called by position, else ""
  bool takes_value = false;
  std::string meaning;
};

struct VerbText {
  std::string name;
  std::string meaning;
  std::vector<OptionText> options;
};

/// The verbs of the program in the order of --help: the one source of completions and manual.
std::vector<VerbText> list_verbs(const CLI::App& app);

/// Completion script for "bash", "zsh" or "fish". Pure.
std::string completion_script(const std::vector<VerbText>& verbs, const std::string& shell);

/// The manual page grouser(1), in troff. Pure.
std::string manual_page(const std::string& meaning, const std::vector<VerbText>& verbs);

}  // namespace grouser
