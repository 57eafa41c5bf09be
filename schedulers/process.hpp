// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace grouser {

/// A process told apart from every other that had or will have its number: the number is used
/// again, number + start time + boot is not.
struct ProcessId {
  std::string host;
  std::string boot;  ///< random id of the host's last boot
  std::int64_t pid = 0;
  std::int64_t start = 0;  ///< clock ticks after boot
  auto operator<=>(const ProcessId&) const = default;
};

/// Local.
ProcessId this_process();

/// Whether the process still runs (a zombie does not); nothing when it belongs to another host, of
/// which this one cannot know. Local.
std::optional<bool> is_alive(const ProcessId& process);

std::string host_name();
std::string boot_id();

/// One line of the process table.
struct ProcessLine {
  std::int64_t pid = 0;
  char state = '?';
  std::int64_t session = 0;
  std::int64_t start = 0;
};

/// @return nothing when `pid` has no process. Local.
std::optional<ProcessLine> process_line(std::int64_t pid);

/// All processes of this host whose session is `session`, zombies left out. Local.
std::vector<ProcessLine> session_processes(std::int64_t session);

/// Whether the environment the process was started with holds `entry` ("NAME=value"). Local.
bool has_environment(std::int64_t pid, const std::string& entry);

}  // namespace grouser
