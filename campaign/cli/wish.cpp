// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/wish.hpp"

#include <algorithm>
#include <iostream>

#include "campaign/cli/attention.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/drive/compare.hpp"
#include "campaign/drive/lease_guard.hpp"

namespace grouser {
namespace {

constexpr double kLeasePatience = 30.0;
constexpr double kStep = 0.5;

bool is_resume(Wish wish) { return wish == Wish::kResume || wish == Wish::kResumeWithEngine; }

bool is_resumable(const RunRow& run) {
  return run.state == State::kHeld || run.state == State::kFailed || run.state == State::kCancelled;
}

// Only a launch makes directories, from the YAML; without one there is nothing to go on from.
void refuse_without_directory(const std::filesystem::path& root, const std::filesystem::path& yaml,
                              const std::vector<RunRow>& runs) {
  std::vector<Problem> problems;
  for (const RunRow& run : runs)
    if (run.in_plan && is_resumable(run) && is_directory_gone(root / run.directory))
      problems.push_back(
          {run.label, 0, 0, "", "its directory " + (root / run.directory).string() + " is gone",
           "grouser submit " + yaml.string() + " makes it again and starts the run anew"});
  if (!problems.empty()) throw ConfigError(problems);
}

bool any_ending(const Store& store, const std::set<RunId>& runs) {
  const auto active = store.active_attempts();
  return std::any_of(active.begin(), active.end(), [&](const AttemptRow& attempt) {
    return runs.count(attempt.run) > 0 && !store.run(attempt.run).request.empty();
  });
}

// A resumed run that is held again was not helped. One that was stopped is held as it was meant.
int code_after(const Store& store, const std::filesystem::path& root, const std::set<RunId>& meant,
               Wish wish) {
  if (!is_resume(wish)) return exit_codes::kOk;
  std::vector<RunRow> runs;
  for (const RunId id : meant) runs.push_back(store.run(id));
  return report_waiting(runs, root);
}

}  // namespace

void add_wish_options(CLI::App& verb, WishOptions& options) {
  verb.add_option("runs", options.runs, "labels, or patterns with * and ?");
  verb.add_flag("--all", options.all, "all runs of the campaign");
  verb.add_option("-C,--campaign", options.where, "root, name or YAML of the campaign");
  add_drive_options(verb, options.drive);
}

std::set<RunId> write_wishes(OpenCampaign& campaign, const WishOptions& options, Wish wish,
                             const std::string& done_word, std::ostream& out) {
  const LeaseGuard lease(campaign.store(), campaign.clock(), kLeasePatience,
                         options.drive.take_over);
  const auto runs = select_runs(campaign.store(), options.runs, options.all);
  if (is_resume(wish))
    refuse_without_directory(campaign.root(), campaign.store().campaign().source, runs);
  std::set<RunId> meant;
  for (const RunRow& run : runs) {
    if (is_resume(wish) && !run.in_plan) {
      if (!options.all) out << run.label << ": the YAML no longer has it, nothing to do\n";
    } else if (make_wish(campaign.store(), run, wish, campaign.clock().now())) {
      meant.insert(run.id);
      out << run.label << ": " << done_word << "\n";
    } else if (!options.all) {
      out << run.label << ": is " << word_of(run.state) << ", nothing to do\n";
    }
  }
  return meant;
}

int carry_out(const WishOptions& options, Wish wish, const std::string& done_word,
              double patience) {
  OpenCampaign campaign(find_root(options.where));
  const auto meant = write_wishes(campaign, options, wish, done_word, std::cout);
  const double end = campaign.clock().now() + patience;
  for (;;) {
    for (const std::string& message : campaign.tick(options.drive, kLeasePatience).messages)
      std::cout << message << "\n";
    if (!any_ending(campaign.store(), meant))
      return code_after(campaign.store(), campaign.root(), meant, wish);
    if (campaign.clock().now() >= end) break;
    campaign.clock().sleep(std::max(kStep, options.drive.every));
  }
  std::cout << "the jobs have been told; grouser tick or status shows when they have ended\n";
  return exit_codes::kOk;
}

}  // namespace grouser
