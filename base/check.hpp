// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace grouser {

/// A defect of the program itself, never of its input (engine exit code 70). Local.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws InternalError naming the broken statement and where it stands. Local.
[[noreturn]] void fail_check(const char* statement, const char* file, int line);

}  // namespace grouser

// Broken logic ends the program; kept on in every build because its cost outside hot loops is nil.
#define GROUSER_CHECK(statement) \
  ((statement) ? static_cast<void>(0) : ::grouser::fail_check(#statement, __FILE__, __LINE__))
