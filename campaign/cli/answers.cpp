// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/answers.hpp"

#include <algorithm>
#include <fstream>

#include "base/errors.hpp"
#include "campaign/drive/driver.hpp"
#include "schedulers/scripts.hpp"

namespace grouser {
namespace {

constexpr int kSchema = 1;
constexpr std::streamoff kLogMost = 1 << 20;

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

Json json_of(const ChunkRow& chunk) {
  return Json{{"position", chunk.position},
              {"state", word_of(chunk.state)},
              {"until_time_s", chunk.until_time ? Json(*chunk.until_time) : Json()},
              {"step", chunk.step},
              {"time_s", chunk.time}};
}

Json json_of(const AttemptRow& attempt) {
  return Json{{"number", attempt.number},
              {"token", attempt.token},
              {"job", attempt.job},
              {"state", word_of(attempt.state)},
              {"code", attempt.code ? Json(*attempt.code) : Json()},
              {"class", attempt.outcome_class},
              {"reason", attempt.reason},
              {"start_step", attempt.start_step},
              {"step", attempt.step},
              {"time_s", attempt.time},
              {"wall_seconds", attempt.wall_seconds},
              {"compute_seconds", attempt.compute_seconds},
              {"checkpoint_seconds", attempt.checkpoint_seconds},
              {"checkpoint", attempt.checkpoint},
              {"state_hash", attempt.state_hash}};
}

Json json_of(const Store& store, const RunRow& run) {
  Json chunks = Json::array();
  for (const ChunkRow& chunk : store.chunks(run.id)) chunks.push_back(json_of(chunk));
  Json attempts = Json::array();
  for (const AttemptRow& attempt : store.attempts(run.id)) attempts.push_back(json_of(attempt));
  return Json{{"label", run.label},
              {"kind", word_of(run.kind)},
              {"state", word_of(run.state)},
              {"reason", run.reason},
              {"directory", run.directory.string()},
              {"key", run.key},
              {"in_plan", run.in_plan},
              {"step", run.step},
              {"time_s", run.time},
              {"checkpoint", run.checkpoint},
              {"state_hash", run.state_hash},
              {"chunks", chunks},
              {"attempts", attempts}};
}

std::string last_lines(const std::string& text, std::size_t count) {
  if (text.empty() || count == 0) return "";
  std::size_t at = text.size();
  if (at > 0 && text[at - 1] == '\n') --at;
  for (; count > 0 && at != std::string::npos; --count)
    at = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  return at == std::string::npos ? text : text.substr(at + 1);
}

}  // namespace

std::vector<RunView> look_at_runs(const std::filesystem::path& root, const Store& store, double now,
                                  bool refresh) {
  const SchedulerKind& kind = scheduler_kind(job_settings(root, store).settings.scheduler);
  const auto scheduler = kind.is_batch && !refresh ? nullptr : kind.make(root);
  auto views = view_runs(store, root, observe(root, store, scheduler.get(), now));
  count_work(store, views);
  return views;
}

bool is_unsettled(const RunView& view) { return view.news && view.news->has_ended; }

std::size_t count_unsettled(const std::vector<RunView>& views) {
  return static_cast<std::size_t>(std::count_if(views.begin(), views.end(), is_unsettled));
}

Json counts_of(const std::vector<RunView>& views) {
  Json counts = Json::object();
  for (const RunView& view : views) {
    Json& count = counts[word_of(view.run.state)];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  return counts;
}

Json status_answer(const Store& store, const std::filesystem::path& root,
                   const std::vector<RunView>& views) {
  const CampaignRow campaign = store.campaign();
  Json runs = Json::array();
  for (const RunView& view : views) runs.push_back(json_of(view));
  return Json{{"schema", kSchema},
              {"campaign", campaign.name},
              {"title", campaign.title},
              {"root", root.string()},
              {"counts", counts_of(views)},
              {"left_out", count_left_out(store)},
              {"unsettled", count_unsettled(views)},
              {"runs", runs}};
}

Json show_answer(const Store& store, const std::vector<RunRow>& runs) {
  Json all = Json::array();
  for (const RunRow& run : runs) all.push_back(json_of(store, run));
  return Json{{"schema", kSchema}, {"runs", all}};
}

Json query_answer(const Table& table) {
  return Json{{"schema", kSchema}, {"rows", rows_json(table)}};
}

LogTail read_log(const Store& store, const std::filesystem::path& root, const RunRow& run,
                 std::int64_t number, std::size_t lines) {
  LogTail tail;
  tail.run = run.label;
  for (const AttemptRow& attempt : store.attempts(run.id)) {
    if (number != 0 && attempt.number != number) continue;
    tail.attempt = attempt.number;
    tail.file = root / run.directory / attempt_files::log(attempt.token);
  }
  if (tail.attempt == 0)
    throw ConfigError({Problem{run.label, 0, 0, "", "has no such attempt", "see grouser show"}});
  std::ifstream file(tail.file, std::ios::binary | std::ios::ate);
  tail.is_there = file.is_open();
  if (!tail.is_there) return tail;
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(size - kLogMost, 0));
  std::string text(static_cast<std::size_t>(std::min(size, kLogMost)), '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  tail.text = last_lines(text, lines);
  return tail;
}

Json logs_answer(const std::vector<LogTail>& logs) {
  Json all = Json::array();
  for (const LogTail& log : logs)
    all.push_back(Json{{"run", log.run},
                       {"attempt", log.attempt},
                       {"file", log.file.string()},
                       {"text", log.is_there ? Json(log.text) : Json()}});
  return Json{{"schema", kSchema}, {"logs", all}};
}

}  // namespace grouser
