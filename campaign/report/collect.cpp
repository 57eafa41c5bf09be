// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/collect.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <map>
#include <set>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/run_contract.hpp"
#include "campaign/report/run_output.hpp"
#include "campaign/store/store.hpp"

namespace grouser {
namespace {

// A picture of more circles than this is slow on a phone and shows no more.
constexpr std::size_t kMostGrains = 4000;

/// Host names by attempt token, from the engine's own "started" records.
std::map<std::string, std::string> hosts_of(const std::filesystem::path& run_directory) {
  std::map<std::string, std::string> hosts;
  std::error_code error;
  std::filesystem::directory_iterator files(run_directory / run_files::kEvents, error);
  if (error) return hosts;
  for (const auto& file : files) {
    const std::string name = file.path().filename().string();
    if (!name.ends_with("started.json")) continue;
    try {
      const Event event = event_from_json(read_file(file.path()).value_or(""), name);
      hosts[event.token] = event.host;
    } catch (const FormatError&) {
      continue;  // a host name less in the provenance
    }
  }
  return hosts;
}

AttemptData attempt_data(const AttemptRow& row, std::int64_t chunk_position) {
  AttemptData attempt;
  attempt.chunk = chunk_position + 1;
  attempt.number = row.number;
  attempt.state = word_of(row.state);
  attempt.outcome = row.reason.empty() ? row.outcome_class : row.reason;
  attempt.job = row.job;
  attempt.started = row.running_at > 0.0 ? row.running_at : row.submitted_at;
  attempt.wall_seconds = row.wall_seconds;
  attempt.compute_seconds = row.compute_seconds;
  attempt.checkpoint_seconds = row.checkpoint_seconds;
  attempt.useful_seconds = row.useful_seconds;
  attempt.lost_seconds = row.lost_seconds + row.hung_seconds;
  // Without an outcome the engine's own measure is missing, but its job was there all the same.
  if (!row.has_outcome) attempt.wall_seconds = attempt.useful_seconds + attempt.lost_seconds;
  attempt.start_step = row.start_step;
  attempt.steps_done = row.steps_done;
  attempt.particles = row.particles;
  attempt.ranks = row.ranks;
  attempt.state_hash = row.state_hash;
  return attempt;
}

/// Fills ReportData step by step; what goes wrong with one file is written down, not thrown.
class Collector {
 public:
  Collector(std::filesystem::path root, double now)
      : root_(std::move(root)), store_(Store::open_read_only(root_ / Store::kFileName)) {
    data_.made_at = date_of(now);
    for (const RunRow& run : store_.runs())
      if (run.in_plan) runs_.push_back(run);
  }

  ReportData collect() {
    const CampaignRow campaign = store_.campaign();
    data_.name = campaign.name;
    data_.title = campaign.title;
    read_settings_of(campaign);
    for (const RunRow& row : runs_) data_.runs.push_back(run_data(row));
    add_attempts();
    add_provenance(campaign);
    return std::move(data_);
  }

 private:
  /// Runs `read`; a file that cannot be used becomes a warning.
  void try_to(const std::function<void()>& read) {
    try {
      read();
    } catch (const ConfigError& error) {
      for (const Problem& problem : error.problems()) data_.warnings.push_back(problem.text());
    } catch (const FormatError& error) {
      data_.warnings.emplace_back(error.what());
    } catch (const StorageError& error) {
      data_.warnings.emplace_back(error.what());
    }
  }

  void read_settings_of(const CampaignRow& campaign) {
    try_to([&] {
      std::vector<Problem> problems;
      // What was submitted, whatever has become of the user's file since.
      const YamlNode file = load_yaml(root_ / kFrozenCampaign);
      const YamlNode* found = file.find("report");
      const YamlNode report = found == nullptr ? YamlNode{} : *found;
      data_.settings = read_report_settings(report, problems);
      data_.recordings =
          read_recordings(report, data_.settings, campaign.source.parent_path(), problems);
      data_.recorded_series =
          read_recorded_series(data_.settings, campaign.source.parent_path(), problems);
      for (const Problem& problem : problems) data_.warnings.push_back(problem.text());
    });
  }

  RunData run_data(const RunRow& row) {
    RunData run;
    run.label = row.label;
    run.directory = row.directory.string();
    run.key = row.key;
    run.state = word_of(row.state);
    run.reason = row.reason;
    run.is_bed = row.kind == RunKind::kBed;
    run.is_finished = row.state == State::kCompleted || row.state == State::kSteady;
    for (const AxisLabel& axis : row.axes) run.axes.emplace_back(axis.axis, axis.label);
    run.time = row.time;
    run.end_time = row.end_time;
    run.particles = row.particles;
    run.state_hash = row.state_hash;
    read_directory(root_ / row.directory, run);
    return run;
  }

  void read_directory(const std::filesystem::path& directory, RunData& run) {
    try_to([&] {
      const std::filesystem::path file = directory / run_files::kCase;
      if (!std::filesystem::exists(file)) return;
      std::vector<Problem> problems;
      run.input = read_case(load_yaml(file), problems);
      run.has_case = problems.empty();
      if (run.end_time <= 0.0) run.end_time = run_duration(run.input);
      for (const Problem& problem : problems) data_.warnings.push_back(problem.text());
    });
    try_to([&] {
      const std::filesystem::path file = directory / run_files::kTrack;
      if (const auto text = read_file(file)) run.track = parse_track(*text, file.string());
    });
    if (run.is_bed) return;
    try_to([&] {
      const std::filesystem::path file = directory / run_files::kSeries;
      if (const auto text = read_file(file)) run.series = parse_series(*text, file.string());
    });
    try_to([&] {
      const std::filesystem::path file = directory / run_files::kSlice;
      if (const auto text = read_file(file))
        run.slice = parse_slice(*text, file.string(), kMostGrains);
    });
  }

  void add_attempts() {
    std::map<std::int64_t, std::size_t> run_at;
    std::map<std::int64_t, std::int64_t> position_of;
    std::vector<std::map<std::string, std::string>> hosts;
    for (const RunRow& row : runs_) {
      run_at[row.id.value] = hosts.size();
      hosts.push_back(hosts_of(root_ / row.directory));
    }
    for (const ChunkRow& chunk : store_.chunks()) position_of[chunk.id.value] = chunk.position;
    for (const AttemptRow& row : store_.attempts()) {
      const auto found = run_at.find(row.run.value);
      if (found == run_at.end()) continue;
      const std::size_t run = found->second;
      std::vector<AttemptData>& attempts = data_.runs[run].attempts;
      AttemptData attempt = attempt_data(row, position_of[row.chunk.value]);
      attempt.host = hosts[run][row.token];
      // The predecessor that left a checkpoint at the step this one starts from.
      for (const AttemptData& before : attempts)
        if (row.start_step > 0 && before.start_step + before.steps_done == row.start_step)
          attempt.restart_hash = before.state_hash;
      attempts.push_back(attempt);
      engines_.insert(row.engine_hash);
    }
  }

  void add_provenance(const CampaignRow& campaign) {
    const auto add = [&](const char* name, const std::string& value) {
      if (!value.empty()) data_.provenance.emplace_back(name, value);
    };
    std::set<std::string> hosts;
    std::set<std::int64_t> seeds;
    double first = 0.0;
    for (const RunData& run : data_.runs) {
      if (run.has_case) seeds.insert(run.input.grains.seed);
      for (const AttemptData& attempt : run.attempts) {
        if (!attempt.host.empty()) hosts.insert(attempt.host);
        if (attempt.started > 0.0 && (first == 0.0 || attempt.started < first))
          first = attempt.started;
      }
    }
    engines_.erase("");
    add("Report made by", std::string("grouser ") + GROUSER_VERSION + ", " + data_.made_at);
    add("Campaign", campaign.name + " from " + campaign.source.filename().string());
    add("Created", date_of(campaign.created_at));
    add("First job", first > 0.0 ? date_of(first) : "none yet");
    add("Engine", std::filesystem::path(campaign.engine).filename().string());
    add("Hash of the engine's program", fmt::format("{}", fmt::join(engines_, ", ")));
    add("Hosts", hosts.empty() ? "" : std::to_string(hosts.size()));
    add("Seeds of the filling", fmt::format("{}", fmt::join(seeds, ", ")));
    for (const Recording& recording : data_.recordings)
      add("Recording", recording.name + ", " + std::to_string(recording.points.size()) + " values");
    for (const RecordedSeries& recording : data_.recorded_series)
      add("Recording", recording.name + ", " + std::to_string(recording.curves.size()) + " series");
  }

  std::filesystem::path root_;
  Store store_;
  std::vector<RunRow> runs_;  // in the plan
  ReportData data_;
  std::set<std::string> engines_;
};

}  // namespace

ReportData collect_report(const std::filesystem::path& campaign_root, double now) {
  return Collector(campaign_root, now).collect();
}

std::string date_of(double seconds) {
  const auto whole = static_cast<std::time_t>(seconds);
  std::tm parts{};
  gmtime_r(&whole, &parts);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min);
}

}  // namespace grouser
