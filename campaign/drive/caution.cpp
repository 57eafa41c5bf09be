// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/caution.hpp"

#include <algorithm>
#include <map>

#include "base/errors.hpp"
#include "base/units.hpp"
#include "campaign/drive/decide.hpp"
#include "campaign/drive/evidence.hpp"

namespace grouser {
namespace {

constexpr int kBadAfter = 2;
constexpr std::size_t kQuickFailures = 3;
constexpr double kQuick = 120.0;
constexpr double kPause = 600.0;
constexpr double kSecondsPerHour = 3600.0;

bool is_infrastructure_failure(const AttemptRow& attempt) {
  return attempt.outcome_class == word_of(OutcomeClass::kInfra);
}

bool got_on(const AttemptRow& attempt) { return attempt.useful_seconds > 0.0; }

}  // namespace

std::vector<std::string> bad_hosts(const std::vector<AttemptRow>& ended) {
  std::map<std::string, int> failures;
  for (const AttemptRow& attempt : ended) {
    if (attempt.host.empty()) continue;
    int& count = failures[attempt.host];
    if (count < 0) continue;  // decided by a later attempt
    if (got_on(attempt))
      count = count >= kBadAfter ? count : -1;
    else if (is_infrastructure_failure(attempt))
      ++count;
  }
  std::vector<std::string> bad;
  for (const auto& [host, count] : failures)
    if (count >= kBadAfter) bad.push_back(host);
  return bad;
}

double pause_end(const std::vector<AttemptRow>& ended) {
  if (ended.size() < kQuickFailures) return 0.0;
  for (std::size_t i = 0; i < kQuickFailures; ++i) {
    // One that was not seen before its end may have begun when it was submitted.
    const bool was_seen = ended[i].running_at < ended[i].absent_since;
    const double lived =
        ended[i].ended_at - (was_seen ? ended[i].running_at : ended[i].submitted_at);
    if (!is_infrastructure_failure(ended[i]) || got_on(ended[i]) || lived > kQuick) return 0.0;
  }
  return ended.front().ended_at + kPause;
}

bool is_checkpoint_suspect(const RunRow& run, const std::vector<AttemptRow>& attempts) {
  if (run.step == 0 || attempts.size() < 2) return false;
  return std::all_of(attempts.end() - 2, attempts.end(), [&](const AttemptRow& attempt) {
    return is_infrastructure_failure(attempt) && !attempt.has_outcome && attempt.running_at > 0.0 &&
           attempt.start_step == run.step && attempt.progress_step <= run.step &&
           attempt.hung_seconds == 0.0;
  });
}

RunRow set_aside_newest(const std::filesystem::path& root, const RunRow& run) {
  const auto directory = root / run.directory / run_files::kCheckpoints;
  const auto newest = newest_checkpoint(root / run.directory);
  if (!newest || newest->step != run.step) return run;
  const auto mark = (directory / newest->file).replace_extension(".json");
  const auto aside = std::filesystem::path(mark).replace_extension(".bad");
  std::error_code error;
  std::filesystem::rename(mark, aside, error);
  if (error) throw StorageError("cannot rename " + mark.string() + ": " + error.message());
  const auto before = newest_checkpoint(root / run.directory);
  if (!before) {
    // The last one there is: better tried again than nothing.
    std::filesystem::rename(aside, mark, error);
    if (error) throw StorageError("cannot rename " + aside.string() + ": " + error.message());
    return run;
  }
  RunRow at = run;
  at.step = before->step;
  at.time = before->time;
  at.checkpoint = before->file;
  at.state_hash = before->state_hash;
  return at;
}

std::string limit_reached(const Settings& settings, std::size_t jobs, double used,
                          std::size_t active) {
  const Limits& limits = settings.limits;
  const std::string go_on = "; raise it, grouser submit --update, then grouser resume";
  if (limits.max_chunks > 0 && jobs >= static_cast<std::size_t>(limits.max_chunks))
    return "limits.max_chunks: the run has had " + std::to_string(jobs) + " jobs" + go_on;
  if (limits.node_hours <= 0.0) return "";
  const Resources& resources = settings.resources;
  const auto nodes = static_cast<double>(std::max<std::int64_t>(resources.nodes, 1));
  const double booked = used + static_cast<double>(active + 1) * resources.walltime;
  const double hours = booked * nodes / kSecondsPerHour;
  if (hours <= limits.node_hours && used * nodes < limits.node_hours * kSecondsPerHour) return "";
  return "limits.node_hours: " + format_number(used * nodes / kSecondsPerHour) +
         " h are used, and another job could take it over " + format_number(limits.node_hours) +
         " h" + go_on;
}

std::string engine_mismatch(const RunRow& run, const std::string& engine_hash) {
  if (run.step == 0 || run.engine_hash.empty() || engine_hash.empty() ||
      run.engine_hash == engine_hash)
    return "";
  return "the engine's program file is not the one that computed the run so far (" + engine_hash +
         " and not " + run.engine_hash +
         "): its bits may differ; put the former back, or go on with `grouser resume "
         "--accept-engine`, which marks the seam in v_seams";
}

}  // namespace grouser
