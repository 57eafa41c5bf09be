// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/launch.hpp"

#include <set>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/hash.hpp"
#include "base/run_contract.hpp"
#include "campaign/drive/fault.hpp"
#include "campaign/drive/wishes.hpp"
#include "schedulers/scripts.hpp"

namespace grouser {
namespace {

void make_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw StorageError("cannot create " + directory.string() + ": " + error.message());
}

// The case names the copy relative to its run directory.
std::filesystem::path surface_copy(const PlannedRun& run, const std::filesystem::path& root) {
  return (root / run.directory / run.input.wheel.stl_file).lexically_normal();
}

void copy_surface(const std::filesystem::path& source, const std::filesystem::path& copy) {
  const std::string hash = copy.stem().string();
  const auto present = read_file(copy);
  if (present && hash_text(*present) == hash) return;
  const auto text = read_file(source);
  if (!text || hash_text(*text) != hash)
    throw StorageError(source.string() + ": changed while it was read; submit again");
  make_directory(copy.parent_path());
  write_atomic(copy, *text);
}

void copy_surfaces(const Plan& plan, const std::filesystem::path& root) {
  std::set<std::filesystem::path> done;
  for (const PlannedRun& run : plan.runs) {
    if (run.surface.empty()) continue;
    const auto copy = surface_copy(run, root);
    if (done.insert(copy).second) copy_surface(run.surface, copy);
  }
}

// A case may change in what its key leaves out, in nothing else.
void freeze_case(const PlannedRun& run, const std::filesystem::path& file) {
  const std::string text = frozen_case(run);
  const auto present = read_file(file);
  if (present == text) return;
  if (present) {
    std::vector<Problem> problems;
    const Case kept = read_case(parse_yaml(*present, file.string()), problems);
    if (!problems.empty() || content_key(kept) != run.key)
      throw FormatError(file.string() +
                        ": not the case that belongs to this directory; move it away");
  }
  write_atomic(file, text);
}

void prepare_directories(const std::vector<const PlannedRun*>& runs,
                         const std::filesystem::path& root) {
  for (const PlannedRun* run : runs) {
    const std::filesystem::path directory = root / run->directory;
    for (const char* part :
         {run_files::kCheckpoints, run_files::kEvents, attempt_files::kDirectory})
      make_directory(directory / part);
    // Last: a directory without it counts as gone.
    freeze_case(*run, directory / run_files::kCase);
  }
}

// Before they are in the plan again: nothing starts them until they are.
void resume_returning(const Plan& plan, double now, Store& store) {
  std::set<std::string> planned;
  for (const PlannedRun& run : plan.runs) planned.insert(run.directory.string());
  for (const RunRow& run : store.runs())
    if (!run.in_plan && run.state == State::kCancelled && planned.count(run.directory.string()) > 0)
      make_wish(store, run, Wish::kResume, now);
}

void cancel_left_out(double now, Store& store) {
  for (const RunRow& run : store.runs())
    // A wish that is being carried out keeps its time, or it would never become impatient.
    if (!run.in_plan && run.request != "cancel") make_wish(store, run, Wish::kCancel, now);
}

CampaignRow campaign_row(const Plan& plan, const std::filesystem::path& source,
                         const std::filesystem::path& engine, double now, const Store& store) {
  CampaignRow campaign;
  campaign.name = plan.name;
  campaign.title = plan.title;
  campaign.source = source;
  campaign.settings = write_settings(plan.settings);
  campaign.engine = engine;
  campaign.created_at = store.has_campaign() ? store.campaign().created_at : now;
  return campaign;
}

}  // namespace

void launch_plan(const Plan& plan, const std::filesystem::path& source,
                 const std::filesystem::path& engine, const std::filesystem::path& root, double now,
                 Store& store) {
  copy_surfaces(plan, root);
  resume_returning(plan, now, store);
  Comparison comparison = compare_runs(plan, root, store);
  prepare_directories(comparison.to_prepare, root);
  fault_point("after_directories");
  comparison.change.campaign = campaign_row(plan, source, engine, now, store);
  store.replace_plan(comparison.change);
  fault_point("after_runs");
  // After the database: made before, they would hide from a launch after a crash that their runs
  // are to start anew.
  prepare_directories(comparison.to_remake, root);
  cancel_left_out(now, store);
  fault_point("after_cancels");
  const auto yaml = read_file(source);
  if (!yaml) throw StorageError("cannot read " + source.string());
  write_atomic(root / kFrozenCampaign, *yaml);
}

}  // namespace grouser
