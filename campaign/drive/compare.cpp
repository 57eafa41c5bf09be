// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/compare.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/run_contract.hpp"

namespace grouser {
namespace {

using ChunkEnds = std::vector<std::optional<double>>;

std::vector<AxisLabel> axes_of(const PlannedRun& planned) {
  std::vector<AxisLabel> axes;
  for (const auto& [axis, label] : planned.axes) axes.push_back({axis, label});
  return axes;
}

NewRun new_run(const PlannedRun& planned) {
  NewRun added;
  added.row.label = planned.label;
  added.row.kind = planned.is_bed ? RunKind::kBed : RunKind::kWheel;
  added.row.directory = planned.directory;
  added.row.key = planned.key;
  added.row.axes = axes_of(planned);
  added.row.end_time = run_duration(planned.input);
  added.bed_key = planned.bed_key;
  added.chunk_ends = planned.chunk_ends;
  return added;
}

bool is_finished(const RunRow& run) {
  return run.state == State::kCompleted || run.state == State::kSteady;
}

// As if nothing of it had been computed; its attempts stay as history.
void start_anew(RunRow& run, const PlannedRun& planned) {
  run.state = run.bed ? State::kPlanned : State::kReady;
  run.reason.clear();
  run.request.clear();
  run.failures = 0;
  run.not_before = 0.0;
  run.step = 0;
  run.time = 0.0;
  run.end_time = run_duration(planned.input);
  run.checkpoint.clear();
  run.state_hash.clear();
  run.particles = 0;
}

class Comparer {
 public:
  Comparer(const Plan& plan, std::filesystem::path root, const Store& store)
      : plan_(plan), root_(std::move(root)) {
    result_.report.is_new = !store.has_campaign();
    for (const AttemptRow& attempt : store.attempts()) begun_.insert(attempt.run);
    for (const ChunkRow& chunk : store.chunks()) ends_[chunk.run].push_back(chunk.until_time);
    // A chunk that walltime cut in two has two rows with one end.
    for (auto& [run, ends] : ends_) ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    for (const RunRow& run : store.runs()) present_.emplace(run.directory.string(), run);
  }

  Comparison compare() {
    for (const PlannedRun& planned : plan_.runs) {
      // Runs are known by their directory: label and content together.
      const auto found = present_.find(planned.directory.string());
      if (found == present_.end()) {
        result_.report.added.push_back(planned.label);
        result_.change.added.push_back(new_run(planned));
        result_.to_prepare.push_back(&planned);
      } else {
        compare_run(planned, found->second);
        present_.erase(found);
      }
    }
    for (const auto& [directory, run] : present_)
      if (run.in_plan) leave_out(run);
    return std::move(result_);
  }

 private:
  void compare_run(const PlannedRun& planned, const RunRow& row) {
    RunRow next = row;
    next.in_plan = true;
    next.label = planned.label;
    next.axes = axes_of(planned);
    if (!row.in_plan) {
      result_.report.back.push_back(planned.label);
      if (next.request == "cancel") next.request.clear();
    }
    const bool is_anew = compare_files(planned, next);
    if (is_anew || next.in_plan != row.in_plan || next.label != row.label || next.axes != row.axes)
      result_.change.runs.push_back(next);
  }

  // @return whether the run starts anew
  bool compare_files(const PlannedRun& planned, RunRow& run) {
    LaunchReport& report = result_.report;
    if (is_directory_gone(root_ / run.directory)) {
      if (is_active(run.state)) {
        report.lost.push_back(run.label);
        return false;
      }
      report.anew.push_back(run.label);
      result_.to_remake.push_back(&planned);
      result_.change.recut.push_back({run.id, planned.chunk_ends});
      start_anew(run, planned);
      return true;
    }
    if (read_file(root_ / run.directory / run_files::kCase) != frozen_case(planned)) {
      result_.to_prepare.push_back(&planned);
      report.recased.push_back(run.label);
      if (is_active(run.state)) report.recased_active.push_back(run.label);
    }
    if (is_finished(run) || ends_[run.id] == planned.chunk_ends) return false;
    if (begun_.count(run.id) > 0)
      report.kept_chunks.push_back(run.label);
    else
      result_.change.recut.push_back({run.id, planned.chunk_ends});
    return false;
  }

  // Its label is free for the run that takes its place in the YAML.
  void leave_out(const RunRow& run) {
    result_.report.gone.push_back(run.label);
    RunRow next = run;
    next.in_plan = false;
    next.label = run.directory.filename().string();
    result_.change.runs.push_back(next);
  }

  const Plan& plan_;
  std::filesystem::path root_;
  std::map<std::string, RunRow> present_;
  std::set<RunId> begun_;
  std::map<RunId, ChunkEnds> ends_;
  Comparison result_;
};

YamlNode yaml_or_nothing(const std::filesystem::path& file) {
  try {
    return load_yaml(file);
  } catch (const ConfigError&) {
    return {};
  }
}

bool is_same(const YamlNode* a, const YamlNode* b) {
  if (a == nullptr || b == nullptr) return a == b;
  return emit_yaml(*a) == emit_yaml(*b);
}

std::vector<std::string> changed_keys(const YamlNode& before, const YamlNode& after) {
  std::vector<std::string> changed;
  for (const auto& [key, value] : after.entries)
    if (!is_same(before.find(key), &value)) changed.push_back(key);
  for (const auto& [key, value] : before.entries)
    if (after.find(key) == nullptr) changed.push_back(key);
  return changed;
}

}  // namespace

bool LaunchReport::is_change() const {
  if (is_new) return false;
  return !added.empty() || !gone.empty() || !back.empty() || !changed_keys.empty() ||
         settings_changed;
}

Comparison compare_runs(const Plan& plan, const std::filesystem::path& root, const Store& store) {
  return Comparer(plan, root, store).compare();
}

LaunchReport compare_plan(const Plan& plan, const std::filesystem::path& source,
                          const std::filesystem::path& root, const Store& store) {
  LaunchReport report = compare_runs(plan, root, store).report;
  if (report.is_new) return report;
  report.settings_changed = store.campaign().settings != write_settings(plan.settings);
  // A launch that was killed before its end has no frozen copy yet, and nothing has begun.
  const std::filesystem::path frozen = root / kFrozenCampaign;
  if (std::filesystem::exists(frozen) || !store.attempts().empty())
    report.changed_keys = changed_keys(yaml_or_nothing(frozen), load_yaml(source));
  return report;
}

std::string frozen_case(const PlannedRun& run) { return emit_yaml(write_case(run.input)); }

bool is_directory_gone(const std::filesystem::path& run_directory) {
  std::error_code unreadable;
  const auto status = std::filesystem::status(run_directory / run_files::kCase, unreadable);
  // What cannot be looked at, for want of permission or of its network, is not gone.
  return status.type() == std::filesystem::file_type::not_found;
}

}  // namespace grouser
