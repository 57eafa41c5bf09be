// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/process.hpp"

#include <dirent.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

namespace grouser {
namespace {

// Files of /proc have no size; they vanish between open and read when the process ends.
std::string slurp(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::optional<std::int64_t> number_in(const char* text) {
  std::int64_t value = 0;
  const char* const end = text + std::strlen(text);
  const auto [rest, error] = std::from_chars(text, end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string boot_id() {
  std::string id = slurp("/proc/sys/kernel/random/boot_id");
  while (!id.empty() && id.back() == '\n') id.pop_back();
  return id;
}

std::optional<ProcessLine> process_line(std::int64_t pid) {
  const std::string text = slurp("/proc/" + std::to_string(pid) + "/stat");
  // The name in parentheses may itself hold blanks and parentheses; fields count from its end.
  const auto close = text.rfind(')');
  if (close == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(close + 1));
  ProcessLine line;
  line.pid = pid;
  std::string skipped;
  fields >> line.state >> skipped >> skipped >> line.session;  // 3 state, 4 ppid, 5 pgrp, 6 session
  for (int field = 7; field < 22; ++field) fields >> skipped;
  fields >> line.start;
  if (!fields) return std::nullopt;
  return line;
}

std::vector<ProcessLine> session_processes(std::int64_t session) {
  std::vector<ProcessLine> found;
  DIR* const directory = ::opendir("/proc");
  if (directory == nullptr) return found;
  while (const dirent* entry = ::readdir(directory)) {
    const auto pid = number_in(entry->d_name);
    if (!pid) continue;
    const auto line = process_line(*pid);
    if (line && line->session == session && line->state != 'Z' && line->state != 'X')
      found.push_back(*line);
  }
  ::closedir(directory);
  return found;
}

bool has_environment(std::int64_t pid, const std::string& entry) {
  const std::string all = '\0' + slurp("/proc/" + std::to_string(pid) + "/environ");
  return all.find('\0' + entry + '\0') != std::string::npos;
}

ProcessId this_process() {
  const auto pid = static_cast<std::int64_t>(::getpid());
  const auto line = process_line(pid);
  return {host_name(), boot_id(), pid, line ? line->start : 0};
}

std::optional<bool> is_alive(const ProcessId& process) {
  if (process.host != host_name()) return std::nullopt;
  if (process.boot != boot_id()) return false;
  const auto line = process_line(process.pid);
  return line && line->start == process.start && line->state != 'Z' && line->state != 'X';
}

}  // namespace grouser
