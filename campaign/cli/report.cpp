// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/report.hpp"

#include <iostream>
#include <memory>

#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {

void add_report(CLI::App& app, int& code) {
  auto where = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("report", "write the campaign's HTML page and CSV tables");
  verb->add_option("-C,--campaign,campaign", *where, "root, name or YAML of the campaign");
  verb->callback([where, &code] {
    const ReportRequest request{find_root(*where)};
    const auto page = write_report(request);
    std::cout << summary_table(request) << "\nreport: " << page.string() << "\n";
    code = exit_codes::kOk;
  });
}

}  // namespace grouser
