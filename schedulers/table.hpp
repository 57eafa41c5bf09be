// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "schedulers/scheduler.hpp"
#include "schedulers/scripts.hpp"

namespace grouser {

/// One kind of scheduler. A new one is a script maker, an implementation and a line in the table.
struct SchedulerKind {
  const char* name;
  std::string (*make_script)(const JobSpec&);
  std::string (*make_array_script)(const ArraySpec&);  ///< nullptr: it has no arrays of ours
  /// @param campaign_root absolute; `local` keeps its job records below it
  std::unique_ptr<Scheduler> (*make)(const std::filesystem::path& campaign_root);
  bool is_batch;          ///< jobs wait in a queue shared with others; asking costs others too
  double query_interval;  ///< seconds between two questions
  double grace;           ///< how long a job may be absent before it counts as gone [s]
};

/// @throws std::invalid_argument when there is no scheduler of that name. Local.
const SchedulerKind& scheduler_kind(const std::string& name);

/// Names of all kinds, in the order of the table. Local.
std::vector<std::string> scheduler_names();

}  // namespace grouser
