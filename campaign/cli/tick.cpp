// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "campaign/cli/attention.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/foreground.hpp"
#include "campaign/cli/progress.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {
namespace {

struct Options {
  std::string where;
  bool wait = false;
  DriveOptions drive;
};

int tick(const Options& options) {
  OpenCampaign campaign(find_root(options.where));
  if (options.wait) {
    if (!drive_in_foreground(campaign, options.drive)) return exit_codes::kAttention;
    return report_waiting(campaign.store().runs(), campaign.root());
  }
  for (const std::string& message : campaign.tick(options.drive, 0.0).messages)
    std::cout << message << "\n";
  std::cout << count_states(view_runs(campaign.store(), campaign.root())) << "\n";
  return report_waiting(campaign.store().runs(), campaign.root());
}

}  // namespace

void add_tick(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("tick", "look at the jobs once and submit what may be submitted");
  verb->add_option("-C,--campaign,campaign", options->where, "root, name or YAML of the campaign");
  verb->add_flag("--wait", options->wait, "tick until the campaign ends");
  add_drive_options(*verb, options->drive);
  verb->callback([options, &code] { code = tick(*options); });
}

}  // namespace grouser
