// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include "base/lattice_units.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {

void add_validate(CLI::App& app, int& code) {
  struct Options {
    std::string file;
    std::string site;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("validate", "check a campaign; name all mistakes at once");
  verb->add_option("file", options->file, "campaign YAML")->required();
  verb->add_option("--site", options->site, "site file with scheduler and resources");
  verb->callback([options, &code] {
    const Plan plan = checked_plan(options->file, options->site);
    const auto beds = std::count_if(plan.runs.begin(), plan.runs.end(), [](const PlannedRun& run) {
      return run.is_bed && !run.input.has_placed;
    });
    std::cout << options->file << ": good; " << plan.runs.size() - static_cast<std::size_t>(beds)
              << " runs on " << beds << " beds\n";
    // Each distinct lattice once, after the first run that has it.
    std::set<std::string> seen;
    for (const PlannedRun& run : plan.runs)
      if (has_lattice(run.input))
        if (const std::string text = lattice_text(run.input); seen.insert(text).second)
          std::cout << run.label << ": " << text << "\n";
    code = exit_codes::kOk;
  });
}

}  // namespace grouser
