// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/drive_options.hpp"

#include <algorithm>
#include <cmath>

#include "campaign/drive/lease_guard.hpp"

namespace grouser {
namespace {

// A job of this machine ends without telling: that is how soon the next one starts.
constexpr double kShortestInterval = 0.25;

// CLI11's own ranges let "nan" through, which compares with nothing.
std::string problem_of_seconds(const std::string& text, bool may_be_zero) {
  double seconds = NAN;
  const bool is_number = CLI::detail::lexical_cast(text, seconds) && std::isfinite(seconds);
  if (is_number && (seconds > 0.0 || (may_be_zero && seconds == 0.0))) return "";
  return "'" + text + "' is no number of seconds " + (may_be_zero ? "from 0 up" : "above 0");
}

}  // namespace

void add_drive_options(CLI::App& verb, DriveOptions& options) {
  verb.add_flag("--take-over", options.take_over,
                "go on although a manager of another host holds the campaign");
  verb.add_option("--grace", options.grace,
                  "seconds a job may be unknown to the scheduler before it counts as gone")
      ->check([](const std::string& text) { return problem_of_seconds(text, true); }, "SECONDS");
  verb.add_option("--every", options.every, "seconds between two looks at the jobs")
      ->check([](const std::string& text) { return problem_of_seconds(text, false); }, "SECONDS");
}

OpenCampaign::OpenCampaign(std::filesystem::path root)
    : root_(std::move(root)), store_(Store::open(root_ / Store::kFileName)) {
  const SchedulerKind& kind = scheduler_kind(read_settings(store_.campaign().settings).scheduler);
  scheduler_name_ = kind.name;
  scheduler_ = kind.make(root_);
}

TickReport OpenCampaign::tick(const DriveOptions& options, double patience) {
  const LeaseGuard lease(store_, clock_, patience, options.take_over);
  Patience limits;
  if (options.grace >= 0.0) limits.grace = options.grace;
  return Driver(root_, store_, *scheduler_, clock_, limits).tick();
}

double OpenCampaign::interval(const DriveOptions& options) const {
  if (options.every > 0.0) return options.every;
  return std::max(kShortestInterval, scheduler_kind(scheduler_name_).query_interval);
}

}  // namespace grouser
