// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/inference/study.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/models/sphere.hpp"

namespace grouser::diagnosis {
namespace {

constexpr std::size_t kMostSamples = 400;

/// Means over blocks, so that a fast camera costs no more than it tells.
void average(std::vector<double>& values, std::size_t block) {
  const std::size_t count = values.size() / block;
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < block; ++k) sum += values[i * block + k];
    values[i] = sum / static_cast<double>(block);
  }
  values.resize(count);
}

/// What is known of a setting in a condition; nothing when nobody says.
const KnownValue* known_value(const SeriesRecording& recording, const Condition& condition,
                              Setting setting) {
  for (const std::vector<KnownValue>* values : {&condition.values, &recording.values})
    for (const KnownValue& known : *values)
      if (known.setting == setting) return &known;
  return nullptr;
}

/// Weights of samples: the second difference beyond what noise makes is taken as an error of its
/// own size at the sample and its neighbours.
std::vector<double> weights_of(const std::vector<double>& values, double noise_sd) {
  const std::size_t n = values.size();
  std::vector<double> weights(n, 1.0);
  if (noise_sd <= 0.0) return weights;
  // Second differences of white noise have a spread of root 6; four of them are no noise.
  const double usual = 4.0 * std::sqrt(6.0) * noise_sd;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double bend = std::abs(values[i + 1] - 2.0 * values[i] + values[i - 1]);
    if (bend <= usual) continue;
    const double weight = 1.0 / std::hypot(1.0, bend / noise_sd);
    for (std::size_t k = i - 1; k <= i + 1; ++k) weights[k] = std::min(weights[k], weight);
  }
  return weights;
}

double range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

/// Centred moving mean over `width` values, an odd number, fewer at the ends.
void smooth(double* values, std::size_t count, std::size_t width) {
  std::vector<double> sums(count + 1, 0.0);
  for (std::size_t i = 0; i < count; ++i) sums[i + 1] = sums[i] + values[i];
  const std::size_t half = width / 2;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i - std::min(i, half);
    const std::size_t to = std::min(count, i + half + 1);
    values[i] = (sums[to] - sums[from]) / static_cast<double>(to - from);
  }
}

/// Height above the floor of every sample: the gap if it is recorded, else the integrated speed,
/// whose lowest point is the floor.
std::vector<double> heights_of(const std::vector<Signal>& channels, const Observed& o) {
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (channels[c] == Signal::kGap) return o.samples[c];
  const double sign = channels[0] == Signal::kSettlingSpeed ? -1.0 : 1.0;
  std::vector<double> heights{0.0};
  for (std::size_t i = 1; i < o.times.size(); ++i)
    heights.push_back(heights.back() + sign * 0.5 * (o.samples[0][i] + o.samples[0][i - 1]) *
                                           (o.times[i] - o.times[i - 1]));
  const double floor = *std::min_element(heights.begin(), heights.end());
  for (double& height : heights) height -= floor;
  return heights;
}

/// First sample near the floor (`heights` below `low`) at which the sphere has met it: a jump, or a
/// recorded speed that within 16 samples falls from half its largest to an eighth of it, as no film
/// of liquid makes it.
std::size_t first_impact(const std::vector<Signal>& channels, const Observed& o,
                         const std::vector<double>& heights, double low) {
  const std::size_t n = heights.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (heights[i] >= low) continue;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (o.weights[c][i] < 0.05) return i;
      if (channels[c] == Signal::kGap || i < 16) continue;
      double largest = 0.0;
      for (std::size_t k = 0; k < n; ++k) largest = std::max(largest, std::abs(o.samples[c][k]));
      if (std::abs(o.samples[c][i - 16]) > 0.5 * largest &&
          std::abs(o.samples[c][i]) < 0.125 * largest)
        return i;
    }
  }
  return n;
}

/// First sample from which a sphere that has bounced stays within 3 % of the fall above the floor;
/// the number of samples if it never does. How it then comes to rest (contact, roughness, steps of
/// a simulation) is no part of the model.
std::size_t start_of_rest(const std::vector<Signal>& channels, const Observed& o) {
  std::vector<double> heights = heights_of(channels, o);
  smooth(heights.data(), heights.size(), 9);  // noise of the gap may be as large as the rest's band
  const double low = *std::min_element(heights.begin(), heights.end()) + 0.03 * range_of(heights);
  const std::size_t jump = first_impact(channels, o, heights, low);
  std::size_t rest = heights.size();
  while (rest > jump && heights[rest - 1] < low) --rest;
  return rest;
}

/// What the rest tells of a channel is where the sphere lies: to 1/500 of its range of positions,
/// and next to nothing of its speed.
void lighten_rest(const std::vector<Signal>& channels, Observed& o) {
  for (std::size_t i = start_of_rest(channels, o); i < o.times.size(); ++i)
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const double error = channels[c] == Signal::kGap ? 0.002 : 0.5;
      const double ratio = error * range_of(o.samples[c]) / o.noise[c].sd;
      o.weights[c][i] = std::min(o.weights[c][i], 1.0 / std::hypot(1.0, ratio));
    }
}

/// Gap at the start of the series, for recordings that do not give the release's.
double first_gap(const std::vector<Signal>& channels, const Observed& observed) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (channels[c] != Signal::kGap) continue;
    const auto count = std::min<std::size_t>(5, observed.times.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += observed.samples[c][i];
    return std::max(0.0, sum / static_cast<double>(count));
  }
  return 1.0;  // far from the floor
}

/// Whether runs of one experiment each have their own value although its prior is the same.
bool is_of_each_run(Setting setting) {
  return setting == Setting::kTrigger || setting == Setting::kReleaseGap ||
         setting == Setting::kReleaseSpeed || setting == Setting::kRestitution;
}

/// No two impacts are alike: a restitution holds to 2 % at best, whatever is stated.
constexpr double kRestitutionError = 0.02;

}  // namespace

double Coordinate::value(double p) const {
  return is_log ? mean * std::exp(sd * p) : mean + sd * p;
}

Study::Study(const SeriesRecording& recording, const Terms& terms, bool held_out) : terms_(terms) {
  for (const SignalChannel& channel : recording.channels) channels_.push_back(channel.signal);
  std::vector<const Condition*> taken;
  for (const Condition& condition : recording.conditions) {
    if (condition.is_held_out() != held_out) continue;
    taken.push_back(&condition);
    Observed o;
    o.name = condition.name;
    o.times = condition.times;
    o.samples = condition.samples;
    const std::size_t block = (o.times.size() + kMostSamples - 1) / kMostSamples;
    if (block > 1) {
      average(o.times, block);
      for (std::vector<double>& values : o.samples) average(values, block);
    }
    o.model = make_sphere_model({o.times, channels_});
    o.first = rows_;
    rows_ += o.times.size() * channels_.size();
    for (const SettingEntry& entry : kSettings)
      if (entry.kind == SettingKind::kAmplitude) o.known[entry.id] = terms[index_of(entry.id)];
    o.known.sensors.assign(channels_.size(), default_values());
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const double stated = recording.channels[c].noise_sd / std::sqrt(double(block));
      o.stated.push_back(stated);
      const double rough = rough_noise_sd(o.samples[c]);
      NoiseModel noise;
      noise.sd = rough > 0.0 ? rough : stated > 0.0 ? stated : 1e-3 * range_of(o.samples[c]);
      noise.freedom = 0.4 * static_cast<double>(o.times.size());
      o.noise.push_back(noise);
      o.weights.push_back(weights_of(o.samples[c], rough));
    }
    observed_.push_back(std::move(o));
  }
  add_baseline(recording, taken);
  for (Observed& o : observed_) lighten_rest(channels_, o);
  align();
}

void Study::add_baseline(const SeriesRecording& recording,
                         const std::vector<const Condition*>& conditions) {
  for (const SettingEntry& entry : kSettings) {
    if (entry.kind != SettingKind::kExperiment) continue;
    std::vector<std::size_t> first;  // baseline_ entries of this setting
    for (std::size_t r = 0; r < conditions.size(); ++r) {
      const KnownValue* known = known_value(recording, *conditions[r], entry.id);
      double mean = known != nullptr ? known->value : entry.off;
      double sd = known != nullptr ? known->uncertainty : 0.0;
      if (known == nullptr && entry.id == Setting::kReleaseGap) {
        mean = first_gap(channels_, observed_[r]);
        sd = 0.02 * mean;
      }
      if (entry.id == Setting::kRestitution) sd = std::hypot(sd, kRestitutionError * mean);
      observed_[r].known[entry.id] = mean;
      if (entry.id == Setting::kTrigger) observed_[r].release = mean;
      if (sd == 0.0) continue;
      const bool is_positive = entry.id == Setting::kDiameter || entry.id == Setting::kViscosity ||
                               entry.id == Setting::kParticleDensity;
      Coordinate c;
      c.label = entry.name;
      c.setting = entry.id;
      c.mean = mean;
      c.is_log = is_positive;
      c.sd = is_positive ? sd / mean : sd;
      bool is_shared = false;
      for (const std::size_t k : first) {
        if (is_of_each_run(entry.id) || baseline_[k].mean != c.mean || baseline_[k].sd != c.sd)
          continue;
        baseline_[k].conditions.push_back(r);
        is_shared = true;
        break;
      }
      if (is_shared) continue;
      c.conditions = {r};
      first.push_back(baseline_.size());
      baseline_.push_back(c);
    }
    if (first.size() > 1)
      for (const std::size_t k : first)
        baseline_[k].label += " " + observed_[baseline_[k].conditions[0]].name;
  }
}

Eigen::VectorXd Study::start(const Coordinates& coordinates) const {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(coordinates.size()));
  for (Eigen::Index j = 0; j < start_.size(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    p(j) = start_(j) * baseline_[at].sd / coordinates[at].sd;
  }
  return p;
}

void Study::align() {
  constexpr double kStep = 0.1;    // of the stated deviation
  constexpr double kFirst = 0.05;  // part of the motion that is looked at, after the last release
  start_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(baseline_.size()));
  for (std::size_t j = 0; j < baseline_.size(); ++j) {
    if (baseline_[j].setting != Setting::kTrigger) continue;
    const std::size_t r = baseline_[j].conditions[0];
    const Observed& o = observed_[r];
    const std::size_t n = o.times.size();
    const double last = o.release + 3.0 * baseline_[j].sd;
    Eigen::VectorXd p = start_;
    double least = INFINITY;
    for (double at = -3.0; at <= 3.0; at += kStep) {
      p(static_cast<Eigen::Index>(j)) = at;
      const std::vector<double> predicted = predict(r, baseline_, p);
      double cost = 0.0;
      for (std::size_t c = 0; c < channels_.size(); ++c)
        for (std::size_t i = 0; i < n && o.times[i] < last + kFirst * duration_of(r); ++i) {
          const double z = (o.samples[c][i] - predicted[c * n + i]) / (5.0 * o.noise[c].sd);
          cost += std::log1p(z * z);  // a wrong curve must not outweigh its beginning
        }
      if (cost >= least) continue;
      least = cost;
      start_(static_cast<Eigen::Index>(j)) = at;
    }
  }
}

bool Study::has_impacts() const {
  for (const Observed& o : observed_)
    for (const std::vector<double>& weights : o.weights)
      if (std::any_of(weights.begin(), weights.end(), [](double w) { return w < 0.3; }))
        return true;
  return false;
}

double Study::duration_of(std::size_t condition) const {
  const Observed& o = observed_[condition];
  return std::max(1e-9, o.times.back() - std::max(o.release, o.times.front()));
}

double Study::scale_of(Scale scale, int channel) const {
  double duration = 0.0;
  double range = 0.0;
  double gap_speed = 0.0;
  double interval = 0.0;
  const auto count = static_cast<double>(observed_.size());
  for (std::size_t r = 0; r < observed_.size(); ++r) {
    const Observed& o = observed_[r];
    duration += duration_of(r) / count;
    interval += (o.times.back() - o.times.front()) / double(o.times.size() - 1) / count;
    const auto at = static_cast<std::size_t>(std::max(0, channel));
    range += range_of(o.samples[at]) / count;
    const bool is_gap = channels_[0] == Signal::kGap;
    gap_speed += range_of(o.samples[0]) / (is_gap ? duration_of(r) : 1.0) / count;
  }
  switch (scale) {
    case Scale::kAbsolute:
      return 1.0;
    case Scale::kSpeed:
      return gap_speed;
    case Scale::kDuration:
      return duration;
    case Scale::kRange:
      return range;
    case Scale::kRate:
      return range / duration;
    case Scale::kInterval:
      return interval;
  }
  return 1.0;
}

Coordinates Study::with(const Hypothesis& hypothesis, int channel) const {
  Coordinates all = baseline_;
  std::vector<std::size_t> every(observed_.size());
  for (std::size_t r = 0; r < every.size(); ++r) every[r] = r;
  if (hypothesis.family == Family::kParameter)
    for (Coordinate& c : all)
      if (c.setting == hypothesis.widened && c.knot < 0)
        c.sd = c.is_log ? std::max(0.15, 10.0 * c.sd) : 10.0 * c.sd;
  for (std::size_t i = 0; i < hypothesis.count; ++i) {
    const FreeSetting& free = hypothesis.free[i];
    double scale = scale_of(free.scale, channel);
    // A frequency is counted in samples, not seconds.
    if (free.setting == Setting::kVibrationFrequency) scale = 1.0 / scale;
    Coordinate c;
    c.label = entry_of(free.setting).name;
    c.setting = free.setting;
    c.channel = entry_of(free.setting).kind == SettingKind::kSensor ? channel : -1;
    c.conditions = every;
    c.mean = free.mean * scale;
    c.sd = free.is_log ? free.sd : free.sd * scale;
    c.is_log = free.is_log;
    c.is_positive = free.is_positive;
    all.push_back(c);
  }
  return all;
}

Coordinates Study::with_latent(int knots, double sd) const {
  Coordinates all = baseline_;
  for (std::size_t r = 0; r < observed_.size(); ++r)
    for (int k = 0; k < knots; ++k) {
      Coordinate c;
      c.label = "latent " + observed_[r].name + " " + std::to_string(k);
      c.knot = k;
      c.conditions = {r};
      c.sd = sd;
      all.push_back(c);
    }
  return all;
}

Settings Study::settings_of(std::size_t condition, const Coordinates& coordinates,
                            const Eigen::VectorXd& p) const {
  Settings settings = observed_[condition].known;
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    const Coordinate& c = coordinates[j];
    if (c.knot >= 0) continue;
    if (std::find(c.conditions.begin(), c.conditions.end(), condition) == c.conditions.end())
      continue;
    const double value = c.value(p(static_cast<Eigen::Index>(j)));
    if (c.channel >= 0)
      settings.sensors[static_cast<std::size_t>(c.channel)][index_of(c.setting)] = value;
    else
      settings[c.setting] = value;
  }
  return settings;
}

std::vector<double> Study::predict(std::size_t condition, const Coordinates& coordinates,
                                   const Eigen::VectorXd& p) const {
  LatentForce latent;
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    const Coordinate& c = coordinates[j];
    if (c.knot < 0 || c.conditions[0] != condition) continue;
    latent.values.push_back(c.value(p(static_cast<Eigen::Index>(j))));
  }
  const double duration = duration_of(condition);
  for (std::size_t k = 0; k < latent.values.size(); ++k)
    latent.times.push_back(duration * static_cast<double>(k) /
                           static_cast<double>(latent.values.size() - 1));
  ++runs_;
  return observed_[condition].model->run(settings_of(condition, coordinates, p), latent);
}

void Study::residual(std::size_t condition, const std::vector<double>& predicted,
                     Eigen::VectorXd& out) const {
  const Observed& o = observed_[condition];
  const std::size_t n = o.times.size();
  double* const at = out.data() + o.first;
  for (std::size_t c = 0; c < channels_.size(); ++c)
    for (std::size_t i = 0; i < n; ++i) at[c * n + i] = o.samples[c][i] - predicted[c * n + i];
  whiten(condition, at);
}

void Study::whiten(std::size_t condition, double* values) const {
  const Observed& o = observed_[condition];
  const std::size_t n = o.times.size();
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    double* const at = values + c * n;
    if (smoothing_ > 1) {
      smooth(at, n, smoothing_);
      for (std::size_t i = 0; i < n; ++i) at[i] /= o.noise[c].sd;
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) at[i] *= o.weights[c][i];
    diagnosis::whiten(o.noise[c], at, n);
  }
}

}  // namespace grouser::diagnosis
