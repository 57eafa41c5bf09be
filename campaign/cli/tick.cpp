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

constexpr double kCarryInterval = 10.0;

struct Options {
  std::string where;
  bool wait = false;
  double patience = 0.0;
  double carry = 0.0;
  DriveOptions drive;
};

int tick(const Options& options) {
  OpenCampaign campaign(find_root(options.where));
  if (options.wait) {
    if (!drive_in_foreground(campaign, options.drive)) return exit_codes::kAttention;
    return report_waiting(campaign.store().runs(), campaign.root());
  }
  const double end = campaign.clock().now() + options.carry;
  for (;;) {
    for (const std::string& message : campaign.tick(options.drive, options.patience).messages)
      std::cout << message << "\n";
    const double now = campaign.clock().now();
    if (now >= end ||
        !needs_another_look(campaign.store().runs(), campaign.store().active_attempts(), now))
      break;
    campaign.clock().sleep(kCarryInterval);
  }
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
  verb->add_option("--patience", options->patience,
                   "seconds to wait for another manager that is at work")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--carry", options->carry,
                   "seconds for which to tick on while an end is to be confirmed or a retry waits")
      ->check(CLI::NonNegativeNumber);
  add_drive_options(*verb, options->drive);
  verb->callback([options, &code] { code = tick(*options); });
}

}  // namespace grouser
