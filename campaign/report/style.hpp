// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// page.css as text; CMake puts it into the program.
extern const char* const kPageStyle;

}  // namespace grouser
