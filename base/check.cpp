// SPDX-License-Identifier: BSD-3-Clause
#include "base/check.hpp"

namespace grouser {

void fail_check(const char* statement, const char* file, int line) {
  throw InternalError(std::string(file) + ":" + std::to_string(line) +
                      ": does not hold: " + statement);
}

}  // namespace grouser
