// SPDX-License-Identifier: BSD-3-Clause
#include "base/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "base/errors.hpp"

namespace grouser {
namespace {

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& file) {
  throw StorageError("cannot " + what + " " + file.string() + ": " + std::strerror(errno));
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }
  // close() reports errors that network file systems delay until then.
  int close() {
    const int result = ::close(number_);
    number_ = -1;
    return result;
  }

 private:
  int number_;
};

bool write_all(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::write(descriptor, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

// Writes, syncs and closes; on failure removes the file again.
void fill(Descriptor& descriptor, const std::filesystem::path& file, const std::string& text) {
  if (write_all(descriptor.get(), text) && ::fsync(descriptor.get()) == 0 &&
      descriptor.close() == 0)
    return;
  const int error = errno;
  ::unlink(file.c_str());
  errno = error;
  fail("write", file);
}

}  // namespace

void write_atomic(const std::filesystem::path& file, const std::string& text) {
  static std::atomic<unsigned> counter{0};
  std::filesystem::path temporary = file;
  temporary += ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
  Descriptor descriptor(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (descriptor.get() < 0) fail("create", temporary);
  fill(descriptor, temporary, text);
  if (::rename(temporary.c_str(), file.c_str()) != 0) {
    const int error = errno;
    ::unlink(temporary.c_str());
    errno = error;
    fail("replace", file);
  }
  sync_path(file.has_parent_path() ? file.parent_path() : ".");
}

bool create_exclusive(const std::filesystem::path& file, const std::string& text) {
  Descriptor descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (descriptor.get() < 0) {
    if (errno == EEXIST) return false;
    fail("create", file);
  }
  fill(descriptor, file, text);
  sync_path(file.has_parent_path() ? file.parent_path() : ".");
  return true;
}

void sync_path(const std::filesystem::path& path) {
  Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0) fail("open", path);
  // Some file systems refuse to sync a directory (EINVAL); they order renames themselves.
  if (::fsync(descriptor.get()) != 0 && errno != EINVAL) fail("sync", path);
}

void check_room(const std::filesystem::path& directory, std::uintmax_t bytes) {
  const std::string wanted = std::to_string(bytes) + " bytes of room in " + directory.string();
  std::error_code error;
  if (std::filesystem::space(directory, error).available < bytes)
    throw StorageError("there are no " + wanted);
  const std::filesystem::path probe = directory / (kRoomProbe + std::to_string(::getpid()));
  Descriptor descriptor(::open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (descriptor.get() < 0) fail("create", probe);
  // fallocate proper: the library's emulation would write every block.
  const int result = ::fallocate(descriptor.get(), 0, 0, static_cast<off_t>(bytes));
  const int reason = errno;
  ::unlink(probe.c_str());
  if (result == 0 || reason == EOPNOTSUPP || reason == ENOSYS || reason == EINVAL) return;
  throw StorageError("there are no " + wanted + ": " + std::strerror(reason));
}

std::optional<std::string> read_file(const std::filesystem::path& file) {
  Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0) {
    if (errno == ENOENT) return std::nullopt;
    fail("open", file);
  }
  std::string text;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t count = ::read(descriptor.get(), buffer, sizeof buffer);
    if (count == 0) return text;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("read", file);
    text.append(buffer, static_cast<std::size_t>(count));
  }
}

}  // namespace grouser
