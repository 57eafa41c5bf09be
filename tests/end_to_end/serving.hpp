// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <regex>
#include <string>
#include <vector>

#include "campaign_run.hpp"

namespace grouser {

/// `grouser serve` in the background on a port of its own while it lives.
class Serving {
 public:
  Serving(const std::filesystem::path& directory, const std::vector<std::string>& words) {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      std::vector<char*> arguments;
      std::vector<std::string> all{GROUSER_PROGRAM, "serve", "--port", "0"};
      all.insert(all.end(), words.begin(), words.end());
      for (std::string& word : all) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::setenv("GROUSER_ENGINE", FAKE_ENGINE, 1);
      if (::chdir(directory.c_str()) == 0) ::execv(GROUSER_PROGRAM, arguments.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    std::string line;
    char c = 0;
    while (::read(ends[0], &c, 1) == 1 && c != '\n') line += c;
    out_ = ends[0];
    std::smatch match;
    if (std::regex_search(line, match, std::regex(":([0-9]+)/"))) port_ = std::stoi(match[1]);
  }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  ~Serving() {
    if (pid_ > 0) stop();
    ::close(out_);
  }

  int port() const { return port_; }
  /// @return its exit code
  int stop() {
    ::kill(pid_, SIGTERM);
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = -1;
  int port_ = 0;
  int out_ = -1;
};

}  // namespace grouser
