// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/case.hpp"
#include "campaign/plan/campaign_file.hpp"

namespace grouser {

/// One run to be done. All its names are plain: they can neither leave the campaign root nor be
/// taken for anything else by a shell.
struct PlannedRun {
  std::string label;
  bool is_bed = false;
  std::filesystem::path directory;  ///< relative to the campaign root
  std::string key;                  ///< content_key of the case
  std::string bed_key;              ///< key of the bed it starts from; "" for a bed
  std::vector<std::pair<std::string, std::string>> axes;  ///< (axis, point), in sweep order
  Case input;
  std::filesystem::path surface;  ///< absolute path of the wheel's STL file, or ""; the case names
                                  ///< the copy ../../surfaces/HASH.stl that a launch makes
  std::vector<std::optional<double>> chunk_ends;  ///< simulated time of each chunk's end [s];
                                                  ///< nothing = the end of the run
};

/// What a campaign comes to. Beds first, each before the runs that start from it.
struct Plan {
  std::string name;
  std::string title;
  Settings settings;
  std::vector<PlannedRun> runs;
  std::vector<Problem> warnings;  ///< what is allowed but seldom meant; one of several runs once
};

/// Expands the sweep: the runs are all combinations of the axes' points, and the distinct beds
/// under them. Every case is read and checked; problems of the cases are appended, one that several
/// runs share once. The plan holds nothing of use when there are problems.
/// @param file  as read by read_campaign without problems
/// Reads STL files, else pure. Local.
Plan make_plan(const CampaignFile& file, std::vector<Problem>& problems);

/// Ends of the chunks of a run. @param duration  of the run [s]; 0 = unknown, then at most `limit`
std::vector<std::optional<double>> chunk_ends(const ChunkRule& rule, double duration, double limit);

/// A further look at the file as read, appending what it finds.
using FileCheck = std::function<void(const CampaignFile&, std::vector<Problem>&)>;

/// Reads and expands a file. @throws ConfigError with every problem. Local.
Plan plan_campaign(const std::filesystem::path& file, const std::filesystem::path& site,
                   const FileCheck& check = {});

}  // namespace grouser
