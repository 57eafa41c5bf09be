// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/machine.hpp"

#include "schedulers/local.hpp"

namespace grouser {
namespace {

// Threads that wait for each other on one core are slow; many of them come to a standstill. Ranks
// have one at least.
constexpr std::int64_t kMostThreadsPerCore = 4;

}  // namespace

void check_machine(const CampaignFile& file, std::vector<Problem>& problems) {
  const std::int64_t ranks = file.settings.resources.ranks;
  const std::int64_t threads = file.settings.resources.threads;
  const std::int64_t cores = available_cores();
  if (file.settings.scheduler != "local" || ranks * threads <= kMostThreadsPerCore * cores) return;
  const std::string key = threads > ranks ? "threads" : "ranks";
  const YamlNode* resources = file.root.find("resources");
  const YamlNode* at = resources == nullptr ? nullptr : resources->find(key);
  if (at == nullptr) at = &file.root;
  const std::string of_threads =
      threads > 1 ? " of " + std::to_string(threads) + " threads each" : "";
  problems.push_back({at->file, at->line, at->column, "resources." + key,
                      std::to_string(ranks) + (ranks == 1 ? " rank" : " ranks") + of_threads +
                          (ranks == 1 ? " is" : " are") + " too many for scheduler local here",
                      "this process may use " + std::to_string(cores) + " cores, and " +
                          std::to_string(kMostThreadsPerCore) +
                          (threads > 1 ? " threads" : " ranks") +
                          " on each are the most that still advance; take fewer, or slurm or pbs"});
}

}  // namespace grouser
