// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace grouser::markup {

/// First violation of XML's rules for elements, attributes and references in `html`, or "". Knows
/// what this project writes: a doctype, elements, double-quoted attributes, five references.
std::string first_fault(const std::string& html);

/// How often `part` occurs in `text`.
int count_of(const std::string& text, const std::string& part);

}  // namespace grouser::markup
