// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include "campaign/cli/attention.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/json_text.hpp"
#include "campaign/cli/progress.hpp"
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

// Its job has ended, and what follows is for the next tick to decide.
bool is_unsettled(const RunView& view) { return view.news && view.news->has_ended; }

Json json_of(const RunView& view) {
  Json axes = Json::object();
  for (const AxisLabel& point : view.run.axes) axes[point.axis] = point.label;
  Json json{{"label", view.run.label},
            {"kind", word_of(view.run.kind)},
            {"state", word_of(view.run.state)},
            {"reason", view.run.reason},
            {"unsettled", is_unsettled(view)},
            {"directory", view.run.directory.string()},
            {"axes", axes},
            {"step", view.run.step},
            {"time_s", view.time},
            {"end_time_s", view.end_time > 0.0 ? Json(view.end_time) : Json()},
            {"chunks", view.chunks},
            {"chunks_done", view.chunks_done},
            {"attempts", view.attempts},
            {"failures", view.run.failures},
            {"checkpoint", view.run.checkpoint},
            {"state_hash", view.run.state_hash},
            {"progress", Json()}};
  if (view.progress)
    json["progress"] = Json{{"phase", view.progress->phase},
                            {"step", view.progress->step},
                            {"particle_steps_per_second", view.progress->particle_steps_per_second},
                            {"seconds_left", view.progress->seconds_left}};
  return json;
}

auto count_unsettled(const std::vector<RunView>& views) {
  return std::count_if(views.begin(), views.end(), is_unsettled);
}

void print_json(const CampaignRow& campaign, const std::filesystem::path& root,
                const std::vector<RunView>& views, std::size_t left_out) {
  Json counts = Json::object();
  for (const RunView& view : views) {
    Json& count = counts[word_of(view.run.state)];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  Json runs = Json::array();
  for (const RunView& view : views) runs.push_back(json_of(view));
  std::cout << json_text(Json{{"schema", 1},
                              {"campaign", campaign.name},
                              {"title", campaign.title},
                              {"root", root.string()},
                              {"counts", counts},
                              {"left_out", left_out},
                              {"unsettled", count_unsettled(views)},
                              {"runs", runs}});
}

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

// A campaign stands still when nobody ticks, and nobody else would say so.
void say_what_is_due(const std::vector<RunView>& views, const std::filesystem::path& root) {
  const auto unsettled = count_unsettled(views);
  std::vector<RunRow> runs;
  bool is_at_work = false;
  for (const RunView& view : views) {
    runs.push_back(view.run);
    is_at_work = is_at_work || (is_active(view.run.state) && !is_unsettled(view));
  }
  if (unsettled > 0)
    std::cout << unsettled << (unsettled == 1 ? " job has" : " jobs have")
              << " ended since the last tick";
  else if (!is_at_work && !is_at_rest(runs))
    std::cout << "no job is at work, and there is more to do";
  else
    return;
  std::cout << "; unless a manager is at work, go on with\n  grouser tick -C " << root.string()
            << "\n";
}

// Jobs of this machine are looked at: that costs nobody anything. A batch system is asked only when
// a person says so.
std::unique_ptr<Scheduler> scheduler_to_ask(const std::filesystem::path& root, const Store& store,
                                            bool refresh) {
  const SchedulerKind& kind = scheduler_kind(job_settings(root, store).settings.scheduler);
  return kind.is_batch && !refresh ? nullptr : kind.make(root);
}

int status(const Options& options) {
  const auto root = find_root(options.where);
  const Store store = Store::open_read_only(root / Store::kFileName);
  const CampaignRow campaign = store.campaign();
  SystemClock clock;
  const auto scheduler = scheduler_to_ask(root, store, options.refresh);
  for (;;) {
    auto views = view_runs(store, root, observe(root, store, scheduler.get(), clock.now()));
    count_work(store, views);
    const std::size_t left_out = count_left_out(store);
    if (options.watch && !options.as_json) std::cout << "\033[H\033[2J";
    if (options.as_json)
      print_json(campaign, root, views, left_out);
    else
      print_table(campaign, root, views, left_out);
    if (!options.as_json) say_what_is_due(views, root);
    std::cout << std::flush;
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
  verb->add_flag("--watch", options->watch, "again every two seconds until Ctrl-C");
  verb->add_flag("--refresh", options->refresh, "ask a batch scheduler as well");
  verb->add_flag("--check", options->check,
                 "exit code 1 when a run is HELD or FAILED, or its job was found dead");
  verb->callback([options, &code] { code = status(*options); });
}

}  // namespace grouser
