// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/launch.hpp"

#include <map>
#include <set>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/run_contract.hpp"
#include "campaign/drive/fault.hpp"
#include "schedulers/scripts.hpp"

namespace grouser {
namespace {

void make_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw StorageError("cannot create " + directory.string() + ": " + error.message());
}

void prepare_directory(const PlannedRun& run, const std::filesystem::path& root) {
  const std::filesystem::path directory = root / run.directory;
  for (const char* part : {run_files::kCheckpoints, run_files::kEvents, attempt_files::kDirectory})
    make_directory(directory / part);
  const std::filesystem::path file = directory / run_files::kCase;
  const std::string text = emit_yaml(write_case(run.input));
  const auto present = read_file(file);
  if (!present) {
    write_atomic(file, text);
    return;
  }
  std::vector<Problem> problems;
  const Case kept = read_case(parse_yaml(*present, file.string()), problems);
  if (!problems.empty() || content_key(kept) != run.key)
    throw FormatError(file.string() +
                      ": not the case that belongs to this directory; move it away");
}

NewRun new_run(const PlannedRun& planned) {
  NewRun added;
  added.row.label = planned.label;
  added.row.kind = planned.is_bed ? RunKind::kBed : RunKind::kWheel;
  added.row.directory = planned.directory;
  added.row.key = planned.key;
  for (const auto& [axis, label] : planned.axes) added.row.axes.push_back({axis, label});
  added.row.end_time = run_duration(planned.input);
  added.bed_key = planned.bed_key;
  added.chunk_ends = planned.chunk_ends;
  return added;
}

// Runs are known by their directory: label and content together.
std::map<std::string, RunRow> runs_by_directory(const Store& store) {
  std::map<std::string, RunRow> runs;
  for (const RunRow& run : store.runs()) runs.emplace(run.directory.string(), run);
  return runs;
}

}  // namespace

LaunchReport compare_plan(const Plan& plan, const std::filesystem::path& source,
                          const std::filesystem::path& root, const Store& store) {
  LaunchReport report;
  report.is_new = !store.has_campaign();
  const auto present = runs_by_directory(store);
  std::set<std::string> planned;
  for (const PlannedRun& run : plan.runs) {
    planned.insert(run.directory.string());
    if (present.count(run.directory.string()) == 0) report.added.push_back(run.label);
  }
  for (const auto& [directory, run] : present)
    if (planned.count(directory) == 0) report.gone.push_back(run.label);
  if (report.is_new) return report;
  report.settings_changed = store.campaign().settings != write_settings(plan.settings);
  report.yaml_changed = read_file(root / kFrozenCampaign) != read_file(source);
  return report;
}

void launch_plan(const Plan& plan, const std::filesystem::path& source,
                 const std::filesystem::path& engine, const std::filesystem::path& root, double now,
                 Store& store) {
  const auto present = runs_by_directory(store);
  std::vector<NewRun> added;
  std::set<std::string> labels;
  for (const auto& [directory, run] : present) labels.insert(run.label);
  for (const PlannedRun& run : plan.runs) {
    if (present.count(run.directory.string()) > 0) continue;
    prepare_directory(run, root);
    added.push_back(new_run(run));
    // A run whose case changed keeps its label in the YAML; the database needs both apart.
    if (!labels.insert(run.label).second)
      added.back().row.label = run.directory.filename().string();
  }
  fault_point("after_directories");
  const bool is_new = !store.has_campaign();
  if (!added.empty()) store.add_runs(added);
  fault_point("after_runs");
  CampaignRow campaign;
  campaign.name = plan.name;
  campaign.title = plan.title;
  campaign.source = source;
  campaign.settings = write_settings(plan.settings);
  campaign.engine = engine;
  campaign.created_at = is_new ? now : store.campaign().created_at;
  store.put_campaign(campaign);
  const auto yaml = read_file(source);
  if (!yaml) throw StorageError("cannot read " + source.string());
  write_atomic(root / kFrozenCampaign, *yaml);
}

}  // namespace grouser
