// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/fsck.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/drive/lease_guard.hpp"
#include "campaign/store/rebuild.hpp"

namespace grouser {
namespace {

struct Options {
  std::string where;
  bool yes = false;
  bool take_over = false;
};

// A database that can be read may only be replaced when that is meant, and by nobody else's side.
void refuse_healthy(const std::filesystem::path& root, const Options& options) {
  const auto file = root / Store::kFileName;
  if (!std::filesystem::exists(file)) return;
  if (!options.yes)
    throw ConfigError({Problem{file.string(), 0, 0, "", "is there",
                               "say --yes to have it replaced; it is kept beside the new one"}});
  try {
    OpenCampaign campaign(root);
    const LeaseGuard lease(campaign.store(), campaign.clock(), 0.0, options.take_over);
  } catch (const StorageError&) {
    // Damaged: nobody can be at work with it.
  } catch (const FormatError&) {
  }
}

int rebuild(const Options& options) {
  const auto root = find_root(options.where);
  refuse_healthy(root, options);
  const std::string old = rebuild_database(root);
  std::cout << (root / Store::kFileName).string() << " is made anew from "
            << (root / kJournalName).string() << "\n";
  if (!old.empty()) std::cout << "the former one is kept as " << old << "\n";
  OpenCampaign campaign(root);
  return prove_and_print(campaign, options.take_over, false);
}

}  // namespace

void add_rebuild(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "rebuild", "make the database anew from the journal, after it was deleted or damaged");
  verb->add_option("-C,--campaign,campaign", options->where, "root, name or YAML of the campaign");
  verb->add_flag("--yes", options->yes, "also when there is a database");
  verb->add_flag("--take-over", options->take_over,
                 "go on although a manager of another host holds the campaign");
  verb->callback([options, &code] { code = rebuild(*options); });
}

}  // namespace grouser
