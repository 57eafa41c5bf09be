// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace grouser {

struct ServiceOptions {
  std::string address = "127.0.0.1";
  int port = 0;             ///< 0 = any that is free
  std::string token;        ///< "" = nothing can be changed
  bool is_private = false;  ///< reading needs the token as well
  double look_every = 2.0;  ///< between two looks for the event stream [s]
};

/// What `serve` may change, by name of the verb ("tick", "stop", ...): done for the campaign whose
/// root is given, and the run ("" for tick). @return what was done, in words
using Action = std::function<std::string(const std::filesystem::path& root, const std::string& verb,
                                         const std::string& run)>;

/// The HTTP service over campaigns: dashboard, JSON with the schemas of the command line, an event
/// stream (docs/reference/serve.md). It reads as `status` does, and serves no file but its own and
/// those of a campaign that are named in a closed list.
class Service {
 public:
  Service(std::vector<std::filesystem::path> roots, ServiceOptions options, Action action);
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;
  ~Service();

  /// Takes the port. @return its number. @throws ConfigError when it cannot be had.
  int bind();
  /// Answers until stop(), from another thread.
  void run();
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace grouser
