// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/progress.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "campaign/cli/text.hpp"
#include "campaign/drive/evidence.hpp"

namespace grouser {

std::vector<RunView> view_runs(const Store& store, const std::filesystem::path& root,
                               const std::vector<Observation>& found) {
  std::vector<RunView> views;
  std::map<RunId, const Observation*> news;
  for (const Observation& one : found) news[one.change.run->id] = &one;
  for (const RunRow& run : store.runs()) {
    if (!run.in_plan) continue;
    RunView& view = views.emplace_back();
    view.run = run;
    if (const auto one = news.find(run.id); one != news.end()) {
      view.news = *one->second;
      view.run = *view.news->change.run;
    }
    view.time = view.run.time;
    view.end_time = view.run.end_time;
    if (!is_active(view.run.state) || (view.news && view.news->has_ended)) continue;
    view.progress = read_progress(root / run.directory);
    if (!view.progress) continue;
    // An attempt before this one may have left the file.
    view.time = std::max(view.time, view.progress->time);
    if (view.progress->end_time > 0.0) view.end_time = view.progress->end_time;
  }
  return views;
}

std::size_t count_left_out(const Store& store) {
  const auto runs = store.runs();
  return static_cast<std::size_t>(
      std::count_if(runs.begin(), runs.end(), [](const RunRow& run) { return !run.in_plan; }));
}

void count_work(const Store& store, std::vector<RunView>& views) {
  std::map<RunId, RunView*> by_id;
  for (RunView& view : views) by_id[view.run.id] = &view;
  for (const AttemptRow& attempt : store.attempts()) {
    const auto view = by_id.find(attempt.run);
    if (view != by_id.end()) ++view->second->attempts;
  }
  for (const ChunkRow& chunk : store.chunks()) {
    const auto view = by_id.find(chunk.run);
    if (view == by_id.end()) continue;
    ++view->second->chunks;
    State state = chunk.state;
    const auto& news = view->second->news;
    if (news && news->change.chunk && news->change.chunk->id == chunk.id)
      state = news->change.chunk->state;
    const bool is_done =
        state == State::kChunkDone || state == State::kCompleted || state == State::kSteady;
    view->second->chunks_done += is_done ? 1 : 0;
  }
}

std::string time_and_end(const RunView& view) {
  std::string text = short_number(view.time);
  if (view.end_time <= 0.0) return text + " s";
  text += " / " + short_number(view.end_time) + " s";
  const double share = std::clamp(view.time / view.end_time, 0.0, 1.0);
  return text + " (" + std::to_string(static_cast<int>(std::floor(100.0 * share))) + " %)";
}

std::string progress_line(const RunView& view, std::size_t label_width) {
  std::string line = view.run.label;
  line += std::string(label_width > line.size() ? label_width - line.size() : 0, ' ');
  line += "  " + std::string(word_of(view.run.state));
  if (!view.progress) return line;
  line += "  " + view.progress->phase + "  " + time_and_end(view);
  line += "  " + short_number(view.progress->particle_steps_per_second, 3) + " particle-steps/s";
  if (view.progress->seconds_left >= 0.0)
    line += "  " + duration_text(view.progress->seconds_left) + " left";
  return line;
}

std::string count_states(const std::vector<RunView>& views) {
  std::map<State, int> counts;
  for (const RunView& view : views) ++counts[view.run.state];
  std::string text;
  for (const auto& [state, count] : counts)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + word_of(state);
  return text;
}

}  // namespace grouser
