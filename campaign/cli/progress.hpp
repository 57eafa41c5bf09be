// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/run_contract.hpp"
#include "campaign/drive/observe.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// Where a run is, from database and progress file.
struct RunView {
  RunRow run;
  std::optional<Progress> progress;  ///< of an active run that has written one
  std::optional<Observation> news;   ///< what no tick has written down yet; `run` holds it
  double time = 0.0;                 ///< simulated [s]
  double end_time = 0.0;             ///< 0 = unknown [s]
  std::int64_t attempts = 0;         ///< this and the next two by count_work
  std::int64_t chunks = 0;
  std::int64_t chunks_done = 0;
};

/// All runs in the plan, as the database has them but for what was found since; reads the progress
/// files of the active ones. Local.
std::vector<RunView> view_runs(const Store& store, const std::filesystem::path& root,
                               const std::vector<Observation>& found = {});

/// How many runs the YAML no longer has.
std::size_t count_left_out(const Store& store);

/// Adds the numbers of attempts and chunks.
void count_work(const Store& store, std::vector<RunView>& views);

/// "0.123 / 0.460 s (27 %)", or what of it is known.
std::string time_and_end(const RunView& view);

/// One line: simulated time and end, speed in particle-steps/s, wall time left.
std::string progress_line(const RunView& view, std::size_t label_width);

/// "3 RUNNING, 5 COMPLETED".
std::string count_states(const std::vector<RunView>& views);

}  // namespace grouser
