// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/analysis.hpp"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr std::size_t kBatches = 10;
// Two slips are one condition when they differ by less than this [1].
constexpr double kSameSlip = 0.01;
// The last row of a finished travel is up to one row's interval before its end; over the window.
constexpr double kWindowSlack = 0.02;

std::vector<double> cut(const std::vector<double>& values, const Window& window) {
  return {values.begin() + static_cast<std::ptrdiff_t>(window.first),
          values.begin() + static_cast<std::ptrdiff_t>(window.end)};
}

/// Slip from the ratio of mean speeds, not the mean of ratios: a towed wheel's spin may pass zero.
Estimate measured_slip(const RunSeries& series, const Window& window, double radius,
                       SlipDefinition definition) {
  const std::vector<double> spin = cut(series.spin, window);
  const std::vector<double> forward = cut(series.forward_speed, window);
  const Estimate mean_spin = batch_means(spin);
  const Estimate mean_forward = batch_means(forward);
  Estimate slip;
  slip.count = std::min(mean_spin.count, mean_forward.count);
  slip.mean = slip_of(definition, radius * mean_spin.mean, mean_forward.mean);
  const std::size_t length = spin.size() / kBatches;
  if (length < 2) return slip;
  std::vector<double> batch_slips;
  for (std::size_t batch = 0; batch < kBatches; ++batch) {
    const auto from = static_cast<std::ptrdiff_t>(spin.size() - (kBatches - batch) * length);
    const auto to = from + static_cast<std::ptrdiff_t>(length);
    const Scatter rim = scatter_of({spin.begin() + from, spin.begin() + to});
    const Scatter axle = scatter_of({forward.begin() + from, forward.begin() + to});
    batch_slips.push_back(slip_of(definition, radius * rim.mean, axle.mean));
  }
  slip.error = scatter_of(batch_slips).deviation / std::sqrt(static_cast<double>(kBatches));
  return slip;
}

RunResult result_of_run(const ReportData& data, std::size_t index) {
  const RunData& run = data.runs[index];
  RunResult result;
  result.run = index;
  result.window = averaging_window(run.series, run.input.wheel, run.is_finished);
  if (result.window.rows() == 0) return result;
  result.slip = measured_slip(run.series, result.window, 0.5 * run.input.wheel.diameter,
                              data.settings.slip_definition());
  for (std::size_t o = 0; o < kObservableCount; ++o)
    result.means[o] = batch_means(cut(run.series.observables[o], result.window), kBatches);
  return result;
}

std::string point_label(const ReportData& data, const RunData& run) {
  std::string label;
  for (const auto& [axis, value] : run.axes)
    if (axis != data.settings.scatter_axis) label += (label.empty() ? "" : " ") + value;
  return label.empty() ? (run.axes.empty() ? run.label : data.name) : label;
}

void average_point(PointResult& point, const std::vector<const RunResult*>& complete) {
  point.complete = complete.size();
  std::vector<double> slips;
  for (const RunResult* run : complete) slips.push_back(run->slip.mean);
  point.slip = scatter_of(slips);
  for (std::size_t o = 0; o < kObservableCount; ++o) {
    std::vector<double> means;
    double squares = 0.0;
    for (const RunResult* run : complete) {
      means.push_back(run->means[o].mean);
      squares += run->means[o].error * run->means[o].error;
    }
    point.observables[o] = scatter_of(means);
    const double within =
        complete.empty() ? kNaN : std::sqrt(squares / static_cast<double>(complete.size()));
    point.chance[o] = std::fmax(point.observables[o].deviation, within);
  }
}

std::vector<PointResult> points_of(const ReportData& data, const Analysis& analysis) {
  std::vector<PointResult> points;
  for (const RunResult& result : analysis.runs) {
    const RunData& run = data.runs[result.run];
    const std::string label = point_label(data, run);
    auto at = std::find_if(points.begin(), points.end(),
                           [&](const PointResult& point) { return point.label == label; });
    if (at == points.end()) {
      at = points.emplace(points.end());
      at->label = label;
      at->is_towed = run.input.wheel.drive == "towed";
    }
    at->runs.push_back(result.run);
  }
  for (PointResult& point : points) {
    std::vector<const RunResult*> complete;
    for (const std::size_t run : point.runs) {
      const RunResult* result = analysis.result_of(run);
      if (result->window.is_complete) complete.push_back(result);
    }
    average_point(point, complete);
  }
  return points;
}

/// Finds the campaign's value for recorded ones.
class Matcher {
 public:
  explicit Matcher(const std::vector<PointResult>& points) {
    for (const PointResult& point : points) {
      if (point.complete == 0) continue;
      if (point.is_towed && towed_ == nullptr) towed_ = &point;
      if (!point.is_towed && std::isfinite(point.slip.mean)) by_slip_.push_back(&point);
    }
    std::sort(by_slip_.begin(), by_slip_.end(), [](const PointResult* a, const PointResult* b) {
      return a->slip.mean < b->slip.mean;
    });
  }

  void match(const RecordingPoint& recorded, Comparison& c) const {
    if (recorded.is_towed()) {
      if (towed_ == nullptr) return;
      take(*towed_, Match::kTowed, recorded.observable, c);
      c.slip = towed_->slip.mean;
      return;
    }
    const auto above = std::lower_bound(
        by_slip_.begin(), by_slip_.end(), c.slip,
        [](const PointResult* point, double slip) { return point->slip.mean < slip; });
    const PointResult* right = above == by_slip_.end() ? nullptr : *above;
    const PointResult* left = above == by_slip_.begin() ? nullptr : *(above - 1);
    const double to_right = right == nullptr ? kNaN : right->slip.mean - c.slip;
    const double to_left = left == nullptr ? kNaN : c.slip - left->slip.mean;
    if (std::fmin(to_right, to_left) <= kSameSlip)
      take(to_right <= kSameSlip && !(to_left < to_right) ? *right : *left, Match::kSlip,
           recorded.observable, c);
    else if (right != nullptr && left != nullptr)
      interpolate(*left, *right, to_left / (to_left + to_right), recorded.observable, c);
  }

 private:
  static void take(const PointResult& point, Match match, Observable observable, Comparison& c) {
    if (!std::isfinite(point.of(observable).mean)) return;
    c.match = match;
    c.label = point.label;
    c.campaign = point.of(observable).mean;
    c.chance = point.chance_of(observable);
  }

  static void interpolate(const PointResult& left, const PointResult& right, double share,
                          Observable observable, Comparison& c) {
    const double low = left.of(observable).mean;
    const double high = right.of(observable).mean;
    if (!std::isfinite(low) || !std::isfinite(high)) return;
    c.match = Match::kInterpolated;
    c.label = left.label + " – " + right.label;
    c.campaign = (1.0 - share) * low + share * high;
    c.chance =
        std::hypot((1.0 - share) * left.chance_of(observable), share * right.chance_of(observable));
  }

  std::vector<const PointResult*> by_slip_;
  const PointResult* towed_ = nullptr;
};

std::vector<Comparison> compare(const ReportData& data, const Analysis& analysis) {
  const Matcher matcher(analysis.points);
  std::vector<Comparison> comparisons;
  for (std::size_t r = 0; r < data.recordings.size(); ++r) {
    const Recording& recording = data.recordings[r];
    for (std::size_t p = 0; p < recording.points.size(); ++p) {
      const RecordingPoint& recorded = recording.points[p];
      Comparison c;
      c.recording = r;
      c.point = p;
      c.slip = convert_slip(recorded.slip, recording.definition(), analysis.slip_definition);
      matcher.match(recorded, c);
      c.difference = c.campaign - recorded.value;
      const double uncertainty = std::isfinite(recorded.uncertainty) ? recorded.uncertainty : 0.0;
      c.tolerance = 2.0 * std::hypot(c.chance, uncertainty);
      comparisons.push_back(c);
    }
  }
  return comparisons;
}

}  // namespace

Window averaging_window(const RunSeries& series, const WheelCase& wheel, bool is_finished) {
  Window window;
  double travelled = 0.0;
  for (std::size_t i = 0; i < series.size(); ++i)
    if (series.phase[i] == "driving") travelled = std::fmax(travelled, series.travel[i]);
  window.to_travel = is_finished ? travelled : wheel.travel;
  window.from_travel = std::max(0.0, window.to_travel - wheel.average_travel);
  bool is_found = false;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (series.phase[i] != "driving" || !(series.travel[i] > window.from_travel)) continue;
    if (!is_found) window.first = i;
    is_found = true;
    window.end = i + 1;
  }
  if (!is_found) return window;
  window.from_time = series.time[window.first];
  window.to_time = series.time[window.end - 1];
  window.is_complete =
      is_finished || travelled >= window.to_travel - kWindowSlack * wheel.average_travel;
  return window;
}

const RunResult* Analysis::result_of(std::size_t run) const {
  const auto at = std::find_if(runs.begin(), runs.end(),
                               [&](const RunResult& result) { return result.run == run; });
  return at == runs.end() ? nullptr : &*at;
}

const char* word_of(Match match) {
  switch (match) {
    case Match::kNone:
      return "none";
    case Match::kTowed:
      return "towed";
    case Match::kSlip:
      return "slip";
    case Match::kInterpolated:
      return "interpolated";
  }
  return "none";
}

Analysis analyse(const ReportData& data) {
  Analysis analysis;
  analysis.slip_definition = data.settings.slip_definition();
  for (std::size_t run = 0; run < data.runs.size(); ++run)
    if (!data.runs[run].is_bed) analysis.runs.push_back(result_of_run(data, run));
  analysis.points = points_of(data, analysis);
  analysis.comparisons = compare(data, analysis);
  return analysis;
}

}  // namespace grouser
