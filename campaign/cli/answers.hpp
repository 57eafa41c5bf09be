// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "campaign/cli/json_text.hpp"
#include "campaign/cli/progress.hpp"
#include "schedulers/scheduler.hpp"

namespace grouser {

// What the reading verbs print with --json, and what `serve` answers: one schema for both
// (docs/reference/cli.md). `schema` grows when a key changes its meaning or goes.

/// The runs as a tick would find them now. A batch system is asked only with `refresh`: that costs
/// others too; jobs of this machine are always looked at. Writes nothing.
std::vector<RunView> look_at_runs(const std::filesystem::path& root, const Store& store, double now,
                                  bool refresh);

/// Its job has ended, and what follows is for the next tick to decide.
bool is_unsettled(const RunView& view);
std::size_t count_unsettled(const std::vector<RunView>& views);

/// Of `status`.
Json status_answer(const Store& store, const std::filesystem::path& root,
                   const std::vector<RunView>& views);
Json counts_of(const std::vector<RunView>& views);

/// Of `show`.
Json show_answer(const Store& store, const std::vector<RunRow>& runs);

/// Of `query`. @throws ConfigError when two columns share a name.
Json query_answer(const Table& table);

/// What an attempt printed. @param number of the attempt; 0 = the last
/// @param lines from the end, of at most the last MiB
/// @throws ConfigError when the run has no such attempt. Reads a file of the run directory. Local.
struct LogTail {
  std::string run;
  std::int64_t attempt = 0;
  std::filesystem::path file;
  bool is_there = false;
  std::string text;
};
LogTail read_log(const Store& store, const std::filesystem::path& root, const RunRow& run,
                 std::int64_t number, std::size_t lines);

/// Of `logs`.
Json logs_answer(const std::vector<LogTail>& logs);

}  // namespace grouser
