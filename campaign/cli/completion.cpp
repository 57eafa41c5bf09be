// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "campaign/cli/command_list.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {

void add_completion(CLI::App& app, int& code) {
  auto shell = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("completion", "print a completion script for a shell");
  verb->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  verb->callback([&app, shell, &code] {
    std::cout << completion_script(list_verbs(app), *shell);
    code = exit_codes::kOk;
  });
}

void add_manual(CLI::App& app, int& code) {
  CLI::App* verb = app.add_subcommand("manual", "print the manual page: grouser manual | man -l -");
  verb->callback([&app, &code] {
    std::cout << manual_page(app.get_description(), list_verbs(app));
    code = exit_codes::kOk;
  });
}

}  // namespace grouser
