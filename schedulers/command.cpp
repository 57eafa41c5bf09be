// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/command.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "base/errors.hpp"

namespace grouser {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::size_t kMaxOutput = std::size_t{64} << 20;
constexpr int kNotFound = 127;

struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw StorageError(std::string("cannot make a pipe: ") + std::strerror(errno));
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
};

[[noreturn]] void become(char* const* words, const char* directory, int out, int err,
                         int exec_error) {
  ::setpgid(0, 0);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing < 0 || ::dup2(nothing, 0) < 0 || ::dup2(out, 1) < 0 || ::dup2(err, 2) < 0 ||
      (*directory != '\0' && ::chdir(directory) != 0))
    ::_exit(kNotFound);
  ::execvp(words[0], words);
  const int error = errno;
  // The parent reads this from the pipe that exec would have closed.
  [[maybe_unused]] const auto written = ::write(exec_error, &error, sizeof error);
  ::_exit(kNotFound);
}

// Reads what is there; false at the end of the stream.
bool drain(int descriptor, std::string& text) {
  std::array<char, 65536> buffer{};
  const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
  if (count < 0) return errno == EINTR || errno == EAGAIN;
  if (count == 0) return false;
  if (text.size() < kMaxOutput) text.append(buffer.data(), static_cast<std::size_t>(count));
  return true;
}

int milliseconds_until(SteadyClock::time_point end) {
  const auto left =
      std::chrono::duration_cast<std::chrono::milliseconds>(end - SteadyClock::now()).count();
  return left < 0 ? 0 : static_cast<int>(std::min<long long>(left, 1000000));
}

// Until both streams end or the time is over.
bool collect(Pipe& out, Pipe& err, CommandResult& result, SteadyClock::time_point end) {
  while (out.ends[0] >= 0 || err.ends[0] >= 0) {
    std::array<pollfd, 2> waiting{pollfd{out.ends[0], POLLIN, 0}, pollfd{err.ends[0], POLLIN, 0}};
    const int ready = ::poll(waiting.data(), waiting.size(), milliseconds_until(end));
    if (ready == 0) return false;
    if (waiting[0].revents != 0 && !drain(out.ends[0], result.out)) out.close_end(0);
    if (waiting[1].revents != 0 && !drain(err.ends[0], result.err)) err.close_end(0);
  }
  return true;
}

// Closing both streams is not ending: waits for the process too, within the time.
int reap(pid_t child, bool& timed_out, SteadyClock::time_point end) {
  int status = 0;
  while (!timed_out) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (milliseconds_until(end) == 0) timed_out = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ::kill(-child, SIGKILL);
  ::kill(child, SIGKILL);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

CommandResult run_command(const std::vector<std::string>& words, double seconds,
                          const std::filesystem::path& directory) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const std::string place = directory.string();
  Pipe out;
  Pipe err;
  Pipe exec_error;
  const pid_t child = ::fork();
  if (child < 0) throw StorageError(std::string("cannot start a process: ") + std::strerror(errno));
  if (child == 0)
    become(arguments.data(), place.c_str(), out.ends[1], err.ends[1], exec_error.ends[1]);
  for (Pipe* pipe : {&out, &err, &exec_error}) pipe->close_end(1);
  const auto end = SteadyClock::now() + std::chrono::milliseconds(static_cast<long>(seconds * 1e3));
  CommandResult result;
  result.timed_out = !collect(out, err, result, end);
  const int status = reap(child, result.timed_out, end);
  int error = 0;
  result.started = ::read(exec_error.ends[0], &error, sizeof error) <= 0;
  if (!result.started) {
    result.err = words.front() + ": " + std::strerror(error);
    return result;
  }
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace grouser
