// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include "campaign/cli/attention.hpp"
#include "campaign/cli/dry_run.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/foreground.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/drive/launch.hpp"
#include "campaign/drive/lease_guard.hpp"
#include "campaign/report/report.hpp"

namespace grouser {
namespace {

// How long a verb waits for another manager's tick to end.
constexpr double kLeasePatience = 30.0;

struct Options {
  std::string file;
  std::string site;
  std::string root;
  std::string engine;
  std::string script_dir;
  bool dry_run = false;
  bool detach = false;
  bool wait = false;
  bool update = false;
  DriveOptions drive;
};

std::string list_of(const std::vector<std::string>& labels) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(labels.size(), kShown); ++i)
    text += (i == 0 ? "" : ", ") + labels[i];
  return labels.size() > kShown ? text + ", ..." : text;
}

void print_changes(const LaunchReport& report) {
  const auto say = [](const std::vector<std::string>& labels, const std::string& what) {
    if (!labels.empty())
      std::cout << labels.size() << " runs " << what << ": " << list_of(labels) << "\n";
  };
  say(report.added, "are new");
  say(report.gone, "that the YAML no longer has are cancelled; their files are kept");
  say(report.back, "that the YAML has again go on");
  say(report.recased, "get another frozen case with the same key (output, limits)");
  say(report.recased_active, "of these have a job at work; it takes effect with their next one");
  // They would be named at every later submit as well.
  const auto& keys = report.changed_keys;
  if (std::find(keys.begin(), keys.end(), "chunks") != keys.end())
    say(report.kept_chunks, "have begun and keep the chunks they have");
  if (report.settings_changed) std::cout << "scheduler, resources or retries change\n";
  for (const std::string& label : report.anew)
    std::cout << label << ": its directory is gone; it starts anew\n";
  for (const std::string& label : report.lost)
    std::cout << label << ": its directory is gone, but its job is at work; "
              << "submit again when that has ended\n";
}

// "in case, sweep": where a person finds the difference.
std::string place_of(const LaunchReport& report) {
  std::string text;
  for (const std::string& key : report.changed_keys) text += (text.empty() ? "" : ", ") + key;
  if (!text.empty()) return text;
  return report.settings_changed ? "scheduler, resources or retries" : "files that it names";
}

// What is submitted stays as it was unless a person says that the change is meant.
void refuse_silent_change(const LaunchReport& report, const Options& options) {
  if (!report.is_change() || options.update) return;
  print_changes(report);
  throw ConfigError({Problem{options.file, 0, 0, "",
                             "differs from the campaign that was submitted in " + place_of(report),
                             "say --update to take the changes over, or give the campaign "
                             "another name or --root"}});
}

int dry_run(const Options& options, const Plan& plan, const std::filesystem::path& root) {
  std::cout << "campaign root: " << root.string() << "\n";
  if (std::filesystem::exists(root / Store::kFileName)) {
    const Store store = Store::open_read_only(root / Store::kFileName);
    const auto report = compare_plan(plan, std::filesystem::absolute(options.file), root, store);
    std::cout << "exists; " << report.added.size() << " runs would be added\n";
    print_changes(report);
  } else {
    std::cout << "new; " << plan.runs.size() << " runs would be made\n";
  }
  show_scripts(plan, root, find_engine(options.engine), options.script_dir);
  return exit_codes::kOk;
}

void launch(const Options& options, const Plan& plan, const std::filesystem::path& root) {
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error) throw StorageError("cannot create " + root.string() + ": " + error.message());
  const auto source = std::filesystem::absolute(options.file).lexically_normal();
  const auto engine = find_engine(options.engine);
  Store store = Store::open(root / Store::kFileName);
  SystemClock clock;
  const LeaseGuard lease(store, clock, kLeasePatience, options.drive.take_over);
  const LaunchReport report = compare_plan(plan, source, root, store);
  refuse_silent_change(report, options);
  launch_plan(plan, source, engine, root, clock.now(), store);
  const auto beds = std::count_if(plan.runs.begin(), plan.runs.end(), [](const PlannedRun& run) {
    return run.is_bed && !run.input.has_placed;
  });
  std::cout << "campaign " << plan.name << ": " << plan.runs.size() - static_cast<std::size_t>(beds)
            << " runs on " << beds << " beds, scheduler " << plan.settings.scheduler << ", in "
            << root.string() << "\n";
  if (!report.is_new) print_changes(report);
}

// Whether every run in the plan has its result.
bool is_complete(const Store& store) {
  const auto runs = store.runs();
  return std::all_of(runs.begin(), runs.end(), [](const RunRow& run) {
    return !run.in_plan || run.state == State::kCompleted || run.state == State::kSteady;
  });
}

void say_how_to_go_on(const std::filesystem::path& root) {
  std::cout << "carry the campaign on with\n"
            << "  grouser tick -C " << root.string() << "     (again and again, or from cron)\n"
            << "and look at it with\n"
            << "  grouser status -C " << root.string() << "\n";
}

int finish(OpenCampaign& campaign) {
  const ReportRequest request{campaign.root()};
  const auto page = write_report(request);
  std::cout << "\n" << summary_table(request) << "\nreport: " << page.string() << "\n";
  if (is_complete(campaign.store())) return exit_codes::kOk;
  if (report_waiting(campaign.store().runs(), campaign.root()) == exit_codes::kOk)
    std::cout << "some runs have no result: grouser status -C " << campaign.root().string() << "\n";
  return exit_codes::kAttention;
}

// After the first jobs, or none when the scheduler took none.
int leave(const OpenCampaign& campaign, const std::vector<RunRow>& runs) {
  const bool is_at_work =
      std::any_of(runs.begin(), runs.end(), [](const RunRow& run) { return is_active(run.state); });
  if (is_at_work || !is_at_rest(runs)) {
    std::cout << (is_at_work ? "jobs run on by themselves; " : "no job is at work yet; ");
    say_how_to_go_on(campaign.root());
  }
  return report_waiting(runs, campaign.root());
}

int submit(const Options& options) {
  const Plan plan = checked_plan(options.file, options.site);
  const auto root = root_of(plan.name, options.root);
  if (options.dry_run) return dry_run(options, plan, root);
  launch(options, plan, root);
  OpenCampaign campaign(root);
  const bool is_batch = scheduler_kind(plan.settings.scheduler).is_batch;
  if (options.detach || (is_batch && !options.wait)) {
    for (const std::string& message : campaign.tick(options.drive, kLeasePatience).messages)
      std::cout << message << "\n";
    return leave(campaign, campaign.store().runs());
  }
  if (drive_in_foreground(campaign, options.drive)) return finish(campaign);
  std::cout << "\ninterrupted; jobs run on by themselves; ";
  say_how_to_go_on(root);
  std::cout << "or in the foreground with the same grouser submit\n";
  return exit_codes::kAttention;
}

}  // namespace

void add_submit(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("submit", "start a campaign, or go on with it");
  verb->add_option("file", options->file, "campaign YAML")->required();
  verb->add_option("--site", options->site, "site file with scheduler and resources");
  verb->add_option("--root", options->root, "campaign root; default is runs/NAME here");
  verb->add_option("--engine", options->engine, "the engine's program file");
  verb->add_flag("--dry-run", options->dry_run, "write nothing; show the job scripts");
  verb->add_option("--script-dir", options->script_dir,
                   "with --dry-run: write the scripts into this directory");
  CLI::Option* detach =
      verb->add_flag("--detach", options->detach, "leave once the first jobs are submitted");
  verb->add_flag("--wait", options->wait, "stay until the campaign ends (default for local)")
      ->excludes(detach);
  verb->add_flag("--update", options->update, "take over changes of the YAML");
  add_drive_options(*verb, options->drive);
  verb->callback([options, &code] { code = submit(*options); });
}

}  // namespace grouser
