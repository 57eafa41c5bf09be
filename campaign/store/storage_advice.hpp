// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace grouser {

/// What to do when SQLite fails with this result code for reasons of the file or the file system;
/// "" for every other code. Local.
std::string storage_advice(int code);

}  // namespace grouser
