// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/dry_run.hpp"

#include <iostream>
#include <map>

#include "base/atomic_file.hpp"
#include "campaign/drive/submit.hpp"

namespace grouser {
namespace {

constexpr const char* kToken = "dryrun000000";

RunRow row_of(const PlannedRun& run) {
  RunRow row;
  row.label = run.label;
  row.directory = run.directory;
  return row;
}

std::string first_script(const JobSettings& shared, const PlannedRun& run, const RunRow* bed) {
  ChunkRow chunk;
  chunk.until_time = run.chunk_ends.front();
  const SchedulerKind& kind = scheduler_kind(shared.settings.scheduler);
  return kind.make_script(job_spec(shared, row_of(run), chunk, bed, kToken));
}

}  // namespace

void show_scripts(const Plan& plan, const std::filesystem::path& root,
                  const std::filesystem::path& engine, const std::string& script_dir) {
  JobSettings shared;
  shared.root = root;
  shared.campaign = plan.name;
  shared.engine = engine;
  shared.home = home_directory();
  shared.settings = plan.settings;
  std::map<std::string, RunRow> beds;
  if (!script_dir.empty()) std::filesystem::create_directories(script_dir);
  for (const PlannedRun& run : plan.runs) {
    const auto bed = beds.find(run.bed_key);
    const std::string script =
        first_script(shared, run, bed == beds.end() ? nullptr : &bed->second);
    if (run.is_bed) beds.emplace(run.key, row_of(run));
    if (script_dir.empty()) {
      std::cout << "\n=== " << run.label << "\n" << script;
      continue;
    }
    const auto file = std::filesystem::path(script_dir) / (run.label + ".sh");
    write_atomic(file, script);
    std::cout << file.string() << "\n";
  }
}

}  // namespace grouser
