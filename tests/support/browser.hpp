// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace grouser {

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Runs headless Chromium and gives back what it made of a page.
class Browser {
 public:
  Browser()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("grouser_browser_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "profile");
  }
  ~Browser() {
    std::error_code ignored;  // a browser process on its way out may still hold a file
    std::filesystem::remove_all(folder_, ignored);
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// What went to standard output; `errors` becomes what went to standard error.
  std::string run(const std::string& options, const std::filesystem::path& page,
                  std::string& errors) const {
    return open(options, "file://" + page.string(), errors);
  }
  std::string open(const std::string& options, const std::string& address,
                   std::string& errors) const {
    const std::filesystem::path out = folder_ / "out";
    const std::filesystem::path err = folder_ / "err";
    const std::string command =
        "timeout 120 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
        "--disable-background-networking --disable-component-update --disable-sync "
        "--hide-scrollbars --enable-logging=stderr --user-data-dir='" +
        (folder_ / "profile").string() + "' " + options + " '" + address + "' >'" + out.string() +
        "' 2>'" + err.string() + "'";
    const int status = std::system(command.c_str());
    errors = text_of(err);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
        << "chromium did not run; it is needed for the tests labelled browser\n"
        << errors;
    return text_of(out);
  }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace grouser
