// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/serve/guard.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"

namespace grouser {
namespace {

constexpr std::size_t kTokenBytes = 32;

// "name:port" or "[v6]:port" without the port.
std::string without_port(const std::string& host) {
  if (host.rfind('[', 0) == 0) return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

std::string random_token() {
  std::ifstream source("/dev/urandom", std::ios::binary);
  std::string token;
  constexpr const char* kDigits = "0123456789abcdef";
  for (std::size_t i = 0; i < kTokenBytes; ++i) {
    const int byte = source.get();
    if (!source) throw StorageError("/dev/urandom: cannot be read");
    token += kDigits[byte / 16];
    token += kDigits[byte % 16];
  }
  return token;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

}  // namespace

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.rfind("127.", 0) == 0;
}

std::set<std::string> own_names(const std::string& address) {
  std::set<std::string> names{address.find(':') == std::string::npos ? address
                                                                     : "[" + address + "]"};
  if (is_loopback(address)) names.insert({"localhost", "127.0.0.1", "[::1]"});
  return names;
}

std::string refusal_of_reading(const RequestOrigin& request, const std::set<std::string>& names) {
  return names.count(without_port(request.host)) > 0
             ? ""
             : "the service is not called '" + request.host.substr(0, 80) + "'";
}

std::string refusal_of_writing(const RequestOrigin& request, const std::set<std::string>& names) {
  if (const std::string why = refusal_of_reading(request, names); !why.empty()) return why;
  if (!request.origin.empty() && request.origin != "http://" + request.host &&
      request.origin != "https://" + request.host)
    return "the request comes from another page";
  if (!request.fetch_site.empty() && request.fetch_site != "same-origin" &&
      request.fetch_site != "none")
    return "the request comes from another page";
  return "";
}

bool carries_token(const RequestOrigin& request, const std::string& token) {
  const std::string wanted = "Bearer " + token;
  const std::string& given = request.authorization;
  std::size_t difference = given.size() ^ wanted.size();
  for (std::size_t i = 0; i < wanted.size(); ++i)
    difference |=
        static_cast<std::size_t>(static_cast<unsigned char>(i < given.size() ? given[i] : 0) ^
                                 static_cast<unsigned char>(wanted[i]));
  return !token.empty() && difference == 0;
}

std::string token_of(const std::filesystem::path& file) {
  // Made for its owner before anything is in it.
  const mode_t before = ::umask(0077);
  const bool is_new = !std::filesystem::exists(file);
  if (is_new) create_exclusive(file, random_token() + "\n");
  ::umask(before);
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) throw StorageError(file.string() + ": cannot be read");
  if ((status.st_mode & 0077U) != 0)
    throw ConfigError({Problem{file.string(), 0, 0, "", "others may read this token",
                               "chmod 600 " + file.string() + ", and use another token"}});
  const std::string token = trimmed(read_file(file).value_or(""));
  if (token.size() < 16 || token.size() > 512 ||
      !std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c < 127; }))
    throw ConfigError(
        {Problem{file.string(), 0, 0, "", "a token is one word of 16 to 512 characters",
                 "delete the file: a new one is made"}});
  return token;
}

std::filesystem::path file_within(const std::filesystem::path& root,
                                  const std::filesystem::path& relative) {
  std::error_code error;
  const auto inside = std::filesystem::canonical(root, error);
  if (error) return {};
  const auto file = std::filesystem::canonical(inside / relative, error);
  if (error || !std::filesystem::is_regular_file(file, error)) return {};
  const auto [end, at] = std::mismatch(inside.begin(), inside.end(), file.begin(), file.end());
  return end == inside.end() ? file : std::filesystem::path();
}

}  // namespace grouser
