// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "base/case.hpp"

namespace grouser {

/// One input value as shown to people.
struct Parameter {
  std::string key;      ///< dotted path as in YAML
  std::string value;    ///< number or word
  std::string unit;     ///< "" for words and pure numbers
  std::string meaning;  ///< one line
};

/// All values of a case in SI units, in the order of its description; two cases with or without a
/// wheel alike give the same keys. Local.
std::vector<Parameter> parameters_of(const Case& input);

}  // namespace grouser
