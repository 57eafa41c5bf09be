// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <iostream>

#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/cli/wish.hpp"

namespace grouser {
namespace {

// Work since the last checkpoint is lost: a person must mean it.
bool is_confirmed(bool yes) {
  if (yes) return true;
  if (::isatty(STDIN_FILENO) != 1) {
    std::cerr << "cancel kills jobs: say --yes\n";
    return false;
  }
  std::cout << "kill the jobs of these runs? work since the last checkpoint is lost [y/N] "
            << std::flush;
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "yes";
}

}  // namespace

void add_cancel(CLI::App& app, int& code) {
  struct Options {
    WishOptions wish;
    bool yes = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("cancel", "kill the jobs of runs; see resume");
  add_wish_options(*verb, options->wish);
  verb->add_flag("--yes", options->yes, "do not ask");
  verb->callback([options, &code] {
    constexpr double kPatience = 20.0;
    code = is_confirmed(options->yes)
               ? carry_out(options->wish, Wish::kCancel, "cancelled", kPatience)
               : exit_codes::kUsage;
  });
}

}  // namespace grouser
