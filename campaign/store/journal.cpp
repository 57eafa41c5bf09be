// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"

namespace grouser {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, int error) {
  const bool is_full = error == ENOSPC || error == EDQUOT;
  throw StorageError(
      file.string() + ": " + std::strerror(error) +
      (is_full ? "; free some space, then the same command goes on; nothing is lost" : ""));
}

// Nothing when the line is torn or is none of ours.
std::optional<std::int64_t> number_of(const std::string& line) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto at = json.find("n");
  if (at == json.end() || !at->is_number_integer()) return std::nullopt;
  return at->get<std::int64_t>();
}

bool write_all(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace

Journal::~Journal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Journal::open() {
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor_ < 0) fail(file_, errno);
  sync_path(file_.parent_path());
}

void Journal::append(const std::string& text) {
  if (descriptor_ < 0) open();
  const off_t end = ::lseek(descriptor_, 0, SEEK_END);
  if (end < 0) fail(file_, errno);
  char last = '\n';
  if (end > 0 && ::pread(descriptor_, &last, 1, end - 1) != 1) fail(file_, errno);
  // What a killed manager left of a line must not become a part of this one.
  const std::string line = (last == '\n' ? "" : "\n") + text + "\n";
  if (write_all(descriptor_, line) && ::fdatasync(descriptor_) == 0) return;
  const int error = errno;
  if (::ftruncate(descriptor_, end) != 0)
    throw StorageError(file_.string() + ": a line could neither be written nor taken back");
  fail(file_, error);
}

std::int64_t Journal::last_number() const {
  std::ifstream in(file_, std::ios::binary | std::ios::ate);
  if (!in) return 0;
  // Lines are short but for those of plans; the tail is doubled until it holds a whole one.
  const auto size = static_cast<std::int64_t>(in.tellg());
  for (std::int64_t tail = 1 << 16;; tail *= 2) {
    const std::int64_t from = std::max<std::int64_t>(0, size - tail);
    std::string text(static_cast<std::size_t>(size - from), '\0');
    in.seekg(from);
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    std::size_t end = text.rfind('\n');
    while (end != std::string::npos && end > 0) {
      const std::size_t before = text.rfind('\n', end - 1);
      if (before == std::string::npos && from > 0) break;
      const std::size_t begin = before == std::string::npos ? 0 : before + 1;
      if (const auto number = number_of(text.substr(begin, end - begin))) return *number;
      end = before;
    }
    if (from == 0) return 0;
  }
}

void read_journal(const std::filesystem::path& file,
                  const std::function<void(std::int64_t, const std::string&)>& use) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw StorageError(file.string() + ": there is no such journal");
  std::string held;
  std::int64_t held_number = 0;
  std::int64_t at = 0;
  for (std::string line; std::getline(in, line);) {
    ++at;
    const auto number = in.eof() ? std::nullopt : number_of(line);  // without its end it is torn
    if (!number) continue;
    // The first may have any number: a journal begins where the database was when it was made.
    if (!held.empty() && *number != held_number && *number != held_number + 1)
      throw FormatError(file.string() + ":" + std::to_string(at) + ": change " +
                        std::to_string(*number) + " follows change " + std::to_string(held_number) +
                        "; the lines between them are damaged");
    if (!held.empty() && *number != held_number) use(held_number, held);
    held = line;
    held_number = *number;
  }
  if (in.bad()) throw StorageError(file.string() + ": cannot be read");
  if (!held.empty()) use(held_number, held);
}

}  // namespace grouser
