// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "campaign/cli/answers.hpp"
#include "campaign/cli/attention.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/interrupt.hpp"
#include "campaign/cli/screen.hpp"
#include "campaign/cli/text.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/drive/clock.hpp"
#include "campaign/drive/driver.hpp"

namespace grouser {
namespace {

constexpr double kWatchInterval = 2.0;

struct Options {
  std::string where;
  bool as_json = false;
  bool watch = false;
  bool check = false;
  bool refresh = false;
};

void print_table(const CampaignRow& campaign, const std::filesystem::path& root,
                 const std::vector<RunView>& views, std::size_t left_out) {
  std::vector<std::vector<std::string>> rows;
  for (const RunView& view : views) {
    const bool has_progress = view.progress.has_value();
    rows.push_back({view.run.label, word_of(view.run.state), time_and_end(view),
                    std::to_string(view.chunks_done) + "/" + std::to_string(view.chunks),
                    std::to_string(view.attempts),
                    has_progress ? short_number(view.progress->particle_steps_per_second, 3) : "",
                    has_progress && view.progress->seconds_left >= 0.0
                        ? duration_text(view.progress->seconds_left)
                        : "",
                    view.run.reason});
  }
  std::cout << campaign.name << "  " << root.string() << "\n"
            << text_table({"RUN", "STATE", "SIMULATED TIME", "CHUNKS", "ATTEMPTS",
                           "PARTICLE-STEPS/S", "LEFT", "REASON"},
                          rows)
            << count_states(views) << "\n";
  if (left_out > 0)
    std::cout << left_out
              << " runs that the YAML no longer has are left out (grouser query "
                 "\"SELECT label, state FROM v_runs WHERE in_plan = 0\")\n";
}

bool needs_attention(const RunView& view) {
  return waits_for_person(view.run.state) || (view.news && view.news->has_failed);
}

// A campaign stands still when nobody ticks, and nobody else would say so. @return "" or what is
// due
std::string what_is_due(const std::vector<RunView>& views) {
  const auto unsettled = count_unsettled(views);
  std::vector<RunRow> runs;
  bool is_at_work = false;
  for (const RunView& view : views) {
    runs.push_back(view.run);
    is_at_work = is_at_work || (is_active(view.run.state) && !is_unsettled(view));
  }
  if (unsettled > 0)
    return std::to_string(unsettled) + (unsettled == 1 ? " job has" : " jobs have") +
           " ended since the last tick";
  return !is_at_work && !is_at_rest(runs) ? "no job is at work, and there is more to do" : "";
}

int watch(const Options& options, const std::filesystem::path& root, const Store& store) {
  const std::string title = store.campaign().name + "  " + root.string();
  SystemClock clock;
  const InterruptGuard guard;
  const FullScreen screen;
  while (!InterruptGuard::is_interrupted() && std::cout) {
    const auto views = look_at_runs(root, store, clock.now(), options.refresh);
    const std::string due = what_is_due(views);
    screen.show(screen_text(title, views, screen.columns(), screen.lines(),
                            due.empty() ? "Ctrl-C leaves; jobs go on" : due + "; grouser tick"));
    clock.sleep(kWatchInterval);
  }
  return exit_codes::kOk;
}

void print_once(const Options& options, const std::filesystem::path& root, const Store& store,
                const std::vector<RunView>& views) {
  if (options.as_json) {
    std::cout << json_text(status_answer(store, root, views)) << std::flush;
    return;
  }
  print_table(store.campaign(), root, views, count_left_out(store));
  if (const std::string due = what_is_due(views); !due.empty())
    std::cout << due << "; unless a manager is at work, go on with\n  grouser tick -C "
              << root.string() << "\n";
  std::cout << std::flush;
}

int status(const Options& options) {
  const auto root = find_root(options.where);
  const Store store = Store::open_read_only(root / Store::kFileName);
  if (options.watch && !options.as_json && ::isatty(STDOUT_FILENO) == 1)
    return watch(options, root, store);
  SystemClock clock;
  for (;;) {
    const auto views = look_at_runs(root, store, clock.now(), options.refresh);
    print_once(options, root, store, views);
    // Nobody would see another look.
    if (!options.watch || !std::cout) {
      const bool waits = std::any_of(views.begin(), views.end(), needs_attention);
      return options.check && waits ? exit_codes::kAttention : exit_codes::kOk;
    }
    clock.sleep(kWatchInterval);
  }
}

}  // namespace

void add_status(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "status", "where every run is; looks at database, files and the jobs of this machine");
  verb->add_option("-C,--campaign,campaign", options->where, "root, name or YAML of the campaign");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->add_flag("--watch", options->watch,
                 "again every two seconds until Ctrl-C; on a terminal the whole screen, with bars");
  verb->add_flag("--refresh", options->refresh, "ask a batch scheduler as well");
  verb->add_flag("--check", options->check,
                 "exit code 1 when a run is HELD or FAILED, or its job was found dead");
  verb->callback([options, &code] { code = status(*options); });
}

}  // namespace grouser
