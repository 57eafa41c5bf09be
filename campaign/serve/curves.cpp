// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/serve/curves.hpp"

#include "base/atomic_file.hpp"
#include "campaign/report/analysis.hpp"
#include "campaign/report/collect.hpp"
#include "campaign/report/run_output.hpp"

namespace grouser {
namespace {

Json thinned(const std::vector<double>& values, std::size_t every) {
  Json out = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i % every == 0 || i + 1 == values.size()) out.push_back(values[i]);
  return out;
}

Json json_of(const Estimate& estimate) {
  return Json{{"mean", estimate.mean}, {"error", estimate.error}};
}

}  // namespace

Json series_answer(const std::filesystem::path& series, std::size_t most) {
  const auto text = series.empty() ? std::nullopt : read_file(series);
  const RunSeries rows = text ? parse_series(*text, series.string()) : RunSeries{};
  const std::size_t every = rows.size() / std::max<std::size_t>(most, 1) + 1;
  Json columns{{"time_s", thinned(rows.time, every)}, {"travel_m", thinned(rows.travel, every)}};
  for (const ObservableEntry& entry : kObservables)
    columns[entry.name] = thinned(rows.of(entry.id), every);
  return Json{{"schema", 1}, {"rows", rows.size()}, {"columns", columns}};
}

Json points_answer(const std::filesystem::path& root, double now) {
  const ReportData data = collect_report(root, now);
  const Analysis analysis = analyse(data);
  Json points = Json::array();
  for (const RunResult& result : analysis.runs) {
    const RunData& run = data.runs[result.run];
    points.push_back(Json{{"label", run.label},
                          {"state", run.state},
                          {"is_complete", result.window.is_complete},
                          {"slip", json_of(result.slip)},
                          {"pull_coefficient", json_of(result.of(Observable::kPullCoefficient))},
                          {"gross_coefficient", json_of(result.of(Observable::kGrossCoefficient))},
                          {"sinkage", json_of(result.of(Observable::kSinkage))}});
  }
  return Json{{"schema", 1}, {"points", points}};
}

}  // namespace grouser
