// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace grouser {

/// What a command left behind.
struct CommandResult {
  bool started = false;    ///< false: there is no such program
  bool timed_out = false;  ///< it was killed because it took too long; it may have had its effect
  int code = -1;           ///< exit code, 128 + signal when killed, -1 when not started
  std::string out;
  std::string err;
};

/// Runs a program with its arguments, without any shell, its input empty, in a process group of
/// its own so that a Ctrl-C at the terminal does not cut it short. Output over 64 MiB is cut off.
/// @param seconds  killed after this time
/// Local.
CommandResult run_command(const std::vector<std::string>& words, double seconds,
                          const std::filesystem::path& directory = {});

}  // namespace grouser
