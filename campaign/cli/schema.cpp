// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>

#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/plan/campaign_file.hpp"
#include "campaign/report/settings.hpp"

namespace grouser {

void add_schema(CLI::App& app, int& code) {
  // Hidden: it makes the reference page, nobody else needs it.
  CLI::App* verb = app.add_subcommand("schema", "")->group("");
  verb->callback([&code] {
    std::cout << campaign_reference() << "\n" << report_reference();
    code = exit_codes::kOk;
  });
}

}  // namespace grouser
