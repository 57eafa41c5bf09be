// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace grouser {

/// A campaign's name: 1 to 64 characters of A-Z a-z 0-9 _ -, not starting with '-'. Local.
bool is_campaign_name(const std::string& text);

/// A label of a sweep point: 1 to 64 characters of A-Z a-z 0-9 . _ + -, not starting with '-' or
/// '.', so that it is a plain file name that no tool takes for an option. Local.
bool is_label(const std::string& text);

/// Names that batch systems take (partition, account, qos): A-Z a-z 0-9 . _ + @ : / = - or empty.
bool is_batch_name(const std::string& text);

/// Memory as batch systems spell it, for example 64G, 500MB; or empty.
bool is_memory(const std::string& text);

/// Text that fits one line: no control characters.
bool is_one_line(const std::string& text);

}  // namespace grouser
