// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include "base/lattice_units.hpp"
#include "base/time_step.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/json_text.hpp"
#include "campaign/cli/text.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {
namespace {

struct Options {
  std::string file;
  std::string site;
  bool as_json = false;
};

Json json_of(const PlannedRun& run) {
  Json ends = Json::array();
  for (const auto& end : run.chunk_ends) ends.push_back(end ? Json(*end) : Json());
  return Json{{"label", run.label},
              {"waits_for_bed", run.bed_key},
              {"simulated_time_s", run_duration(run.input)},
              {"time_step_s", time_step_of(run.input)},
              {"chunk_ends_s", ends}};
}

std::string ends_text(const PlannedRun& run) {
  constexpr std::size_t kShown = 6;
  std::string text;
  for (std::size_t i = 0; i < run.chunk_ends.size(); ++i) {
    if (i == kShown) return text + ", ...";
    const auto& end = run.chunk_ends[i];
    text += (i == 0 ? "" : ", ") + (end ? short_number(*end) + " s" : std::string("end"));
  }
  return text;
}

// Each distinct step of the runs once, after the first run that has it.
std::string step_lines(const Plan& plan) {
  constexpr std::size_t kShown = 6;
  std::vector<std::string> seen;
  std::string text;
  for (const PlannedRun& run : plan.runs) {
    std::string line = time_step_text(run.input);
    if (has_lattice(run.input)) line += "\n  " + lattice_text(run.input);
    if (std::find(seen.begin(), seen.end(), line) != seen.end()) continue;
    if (seen.size() == kShown) return text + "...\n";
    seen.push_back(line);
    text += run.label + ": " + line + "\n";
  }
  return text;
}

int plan_verb(const Options& options) {
  const Plan plan = checked_plan(options.file, options.site);
  if (options.as_json) {
    Json runs = Json::array();
    for (const PlannedRun& run : plan.runs) runs.push_back(json_of(run));
    std::cout << json_text(Json{{"schema", 1}, {"campaign", plan.name}, {"runs", runs}});
    return exit_codes::kOk;
  }
  std::vector<std::vector<std::string>> rows;
  std::size_t jobs = 0;
  for (const PlannedRun& run : plan.runs) {
    jobs += run.chunk_ends.size();
    const double duration = run_duration(run.input);
    rows.push_back({run.label, run.bed_key.empty() ? "-" : "bed-" + run.bed_key.substr(0, 8),
                    duration > 0.0 ? short_number(duration) + " s" : "until settled",
                    std::to_string(run.chunk_ends.size()), ends_text(run)});
  }
  const Resources& resources = plan.settings.resources;
  std::cout << text_table({"RUN", "WAITS FOR", "SIMULATED TIME", "CHUNKS", "ENDING AT"}, rows)
            << "\n"
            << jobs << " jobs at least, scheduler " << plan.settings.scheduler << ", "
            << resources.ranks << " ranks each"
            << (resources.threads > 1 ? " of " + std::to_string(resources.threads) + " threads"
                                      : "")
            << (resources.walltime > 0.0 ? ", walltime " + duration_text(resources.walltime) : "")
            << "\n"
            << step_lines(plan);
  return exit_codes::kOk;
}

}  // namespace

void add_plan(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("plan", "show how the runs are cut into jobs");
  verb->add_option("file", options->file, "campaign YAML")->required();
  verb->add_option("--site", options->site, "site file with scheduler and resources");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->callback([options, &code] { code = plan_verb(*options); });
}

}  // namespace grouser
