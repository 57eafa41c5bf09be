// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/starter.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {

void add_init(CLI::App& app, int& code) {
  auto file = std::make_shared<std::string>("campaign.yaml");
  CLI::App* verb = app.add_subcommand("init", "write a commented campaign to start from");
  verb->add_option("file", *file, "file to write; refused if it exists")->capture_default_str();
  verb->callback([file, &code] {
    if (!create_exclusive(*file, kStarterCampaign))
      throw ConfigError({Problem{*file, 0, 0, "", "exists already", "name another file"}});
    std::cout << "wrote " << *file << "\nnext: grouser validate " << *file << "\n";
    code = exit_codes::kOk;
  });
}

}  // namespace grouser
