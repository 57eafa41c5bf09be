// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "campaign/cli/drive_options.hpp"
#include "campaign/drive/wishes.hpp"

namespace grouser {

/// Command line of the verbs that say something about runs.
struct WishOptions {
  std::string where;
  std::vector<std::string> runs;
  bool all = false;
  DriveOptions drive;
};

void add_wish_options(CLI::App& verb, WishOptions& options);

/// Writes the wish down for each chosen run, saying so on `out`; ticks carry it out.
/// @return the runs to which it meant something. @throws ConfigError, CampaignBusy
std::set<RunId> write_wishes(OpenCampaign& campaign, const WishOptions& options, Wish wish,
                             const std::string& done_word, std::ostream& out);

/// Writes the wish down for each chosen run and ticks until no chosen run is about to end, or
/// `patience` seconds have passed. @return exit code
int carry_out(const WishOptions& options, Wish wish, const std::string& done_word, double patience);

}  // namespace grouser
