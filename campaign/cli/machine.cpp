// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/machine.hpp"

#include "schedulers/local.hpp"

namespace grouser {
namespace {

// Ranks that wait for each other on one core are slow; many of them come to a standstill.
constexpr std::int64_t kMostRanksPerCore = 4;

}  // namespace

void check_machine(const CampaignFile& file, std::vector<Problem>& problems) {
  const std::int64_t ranks = file.settings.resources.ranks;
  const std::int64_t cores = available_cores();
  if (file.settings.scheduler != "local" || ranks <= kMostRanksPerCore * cores) return;
  const YamlNode* resources = file.root.find("resources");
  const YamlNode* at = resources == nullptr ? nullptr : resources->find("ranks");
  if (at == nullptr) at = &file.root;
  problems.push_back({at->file, at->line, at->column, "resources.ranks",
                      std::to_string(ranks) + " ranks are too many for scheduler local here",
                      "this process may use " + std::to_string(cores) + " cores, and " +
                          std::to_string(kMostRanksPerCore) +
                          " ranks on each are the most that still advance; take fewer, or slurm or "
                          "pbs"});
}

}  // namespace grouser
