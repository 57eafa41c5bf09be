// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/plan/expand.hpp"

#include <iostream>
#include <memory>

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
  std::string case_of;
  bool as_json = false;
};

Json json_of(const PlannedRun& run) {
  Json axes = Json::object();
  for (const auto& [axis, label] : run.axes) axes[axis] = label;
  return Json{{"label", run.label},
              {"kind", run.is_bed ? "bed" : "wheel"},
              {"directory", run.directory.string()},
              {"key", run.key},
              {"bed_key", run.bed_key},
              {"axes", axes}};
}

int expand(const Options& options) {
  const Plan plan = checked_plan(options.file, options.site);
  if (!options.case_of.empty()) {
    for (const PlannedRun& run : plan.runs) {
      if (run.label != options.case_of) continue;
      if (options.as_json)
        std::cout << json_text(
            Json{{"schema", 1}, {"run", run.label}, {"case", case_json(run.input)}});
      else
        std::cout << emit_yaml(write_case(run.input));
      return exit_codes::kOk;
    }
    throw ConfigError({Problem{options.case_of, 0, 0, "", "no run is called so", ""}});
  }
  if (options.as_json) {
    Json runs = Json::array();
    for (const PlannedRun& run : plan.runs) runs.push_back(json_of(run));
    std::cout << json_text(Json{{"schema", 1}, {"campaign", plan.name}, {"runs", runs}});
    return exit_codes::kOk;
  }
  std::vector<std::vector<std::string>> rows;
  for (const PlannedRun& run : plan.runs) {
    std::string axes;
    for (const auto& [axis, label] : run.axes)
      axes += (axes.empty() ? "" : " ") + axis + "=" + label;
    rows.push_back({run.label, run.is_bed ? "bed" : "wheel", run.directory.string(), axes});
  }
  std::cout << text_table({"RUN", "KIND", "DIRECTORY", "POINTS"}, rows);
  return exit_codes::kOk;
}

}  // namespace

void add_expand(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("expand", "list the runs a campaign comes to");
  verb->add_option("file", options->file, "campaign YAML")->required();
  verb->add_option("--site", options->site, "site file with scheduler and resources");
  verb->add_option("--case", options->case_of, "print the whole case of this run in SI units");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->callback([options, &code] { code = expand(*options); });
}

}  // namespace grouser
