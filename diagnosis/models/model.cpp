// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/models/model.hpp"

#include <algorithm>
#include <cmath>

namespace grouser::diagnosis {

void apply_lag(double lag, const std::vector<double>& times, double* values) {
  double before = values[0];
  double state = values[0];
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step = times[i] - times[i - 1];
    const double slope = (values[i] - before) / step;
    const double now = values[i];
    // y' = (x - y)/lag with x = before + slope s.
    state = now - slope * lag + (state - before + slope * lag) * std::exp(-step / lag);
    before = now;
    values[i] = state;
  }
}

SettingValues default_values() {
  SettingValues values{};
  for (const SettingEntry& entry : kSettings) values[index_of(entry.id)] = entry.off;
  return values;
}

double LatentForce::at(double time) const {
  if (times.empty() || time < times.front() || time > times.back()) return 0.0;
  const auto above = std::upper_bound(times.begin(), times.end(), time);
  if (above == times.end()) return values.back();
  const auto i = static_cast<std::size_t>(above - times.begin());
  const double part = (time - times[i - 1]) / (times[i] - times[i - 1]);
  return values[i - 1] + part * (values[i] - values[i - 1]);
}

void apply_sensor(const SettingValues& sensor, const std::vector<double>& times, double* values) {
  const auto of = [&](Setting setting) { return sensor[index_of(setting)]; };
  const std::size_t n = times.size();
  const double gain = 1.0 + of(Setting::kGain);
  const double zero = of(Setting::kZero);
  const double drift = of(Setting::kDrift);
  if (gain != 1.0 || zero != 0.0 || drift != 0.0)
    for (std::size_t i = 0; i < n; ++i) values[i] = gain * values[i] + zero + drift * times[i];
  if (of(Setting::kClip) > 0.0) {
    const auto [low, high] = std::minmax_element(values, values + n);
    const double top = *high - of(Setting::kClip) * (*high - *low);
    for (std::size_t i = 0; i < n; ++i) values[i] = std::min(values[i], top);
  }
}

}  // namespace grouser::diagnosis
