// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/fsck.hpp"

#include <iostream>

#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/json_text.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/drive/lease_guard.hpp"
#include "campaign/drive/prove.hpp"

namespace grouser {
namespace {

constexpr double kLeasePatience = 30.0;

struct Options {
  std::string where;
  bool as_json = false;
  bool take_over = false;
};

void print_json(const std::vector<Difference>& found) {
  Json all = Json::array();
  for (const Difference& one : found)
    all.push_back({{"place", one.place}, {"what", one.what}, {"hint", one.hint}});
  std::cout << json_text(Json{{"schema", 1}, {"differences", all}});
}

int fsck(const Options& options) {
  OpenCampaign campaign(find_root(options.where));
  return prove_and_print(campaign, options.take_over, options.as_json);
}

}  // namespace

int prove_and_print(OpenCampaign& campaign, bool take_over, bool as_json) {
  const LeaseGuard lease(campaign.store(), campaign.clock(), kLeasePatience, take_over);
  const auto found = prove(campaign.root(), campaign.store(), campaign.scheduler());
  const int code = found.empty() ? exit_codes::kOk : exit_codes::kAttention;
  if (as_json) {
    print_json(found);
    return code;
  }
  for (const Difference& one : found)
    std::cout << one.place << ": " << one.what << "\n  " << one.hint << "\n";
  if (found.empty())
    std::cout << "database, journal, files and scheduler agree\n";
  else
    std::cout << found.size() << (found.size() == 1 ? " difference\n" : " differences\n");
  return code;
}

void add_fsck(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "fsck", "prove that database, journal, files and scheduler agree; changes nothing");
  verb->add_option("-C,--campaign,campaign", options->where, "root, name or YAML of the campaign");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->add_flag("--take-over", options->take_over,
                 "go on although a manager of another host holds the campaign");
  verb->callback([options, &code] { code = fsck(*options); });
}

}  // namespace grouser
