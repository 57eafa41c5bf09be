// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "diagnosis/recordings/settings.hpp"

namespace grouser::diagnosis {

using SettingValues = std::array<double, kSettingCount>;

/// Every setting at the value where it has no effect, or which is taken when nothing is said.
SettingValues default_values();

/// What a model is told: settings of the run, and those of kind kSensor once per channel.
struct Settings {
  SettingValues values = default_values();
  std::vector<SettingValues> sensors;  ///< one per channel; only kSensor entries are read

  double operator[](Setting setting) const { return values[index_of(setting)]; }
  double& operator[](Setting setting) { return values[index_of(setting)]; }
};

/// An unknown upward force on the tracked body over its buoyant weight, straight between knots and
/// 0 outside. Empty = none.
struct LatentForce {
  std::vector<double> times;   ///< [s] after the release, ascending
  std::vector<double> values;  ///< [1]

  double at(double time) const;
};

/// When and what a model is asked for.
struct ModelPlan {
  std::vector<double> times;  ///< [s] on the recording's clock, ascending
  std::vector<Signal> channels;
};

/// Settings in, channels out: what the diagnosis knows of a simulation. A small ODE here; runs of
/// the engine answer the same question for beds and wheels.
class Model {
 public:
  virtual ~Model() = default;

  /// Channels one after the other, each as long as the plan's times, sensors applied. Local.
  virtual std::vector<double> run(const Settings& settings, const LatentForce& latent) const = 0;

  /// Upward force that `term` alone exerts in such a run, over the buoyant weight, at the plan's
  /// times; of a setting of the experiment, the force that grows with it. Zeros when it acts
  /// elsewhere (a sensor). Local.
  virtual std::vector<double> force_of(Setting term, const Settings& settings) const = 0;
};

/// First-order lag of values that are straight between the samples, exactly, in place. Local.
void apply_lag(double lag, const std::vector<double>& times, double* values);

/// What moved the sensor away from the body: `values` at `times` after gain, zero, drift and
/// clipping of `sensor`, in that order, in place. Lag and filter must be applied before by the
/// caller, who has the curve between the samples. Local.
void apply_sensor(const SettingValues& sensor, const std::vector<double>& times, double* values);

}  // namespace grouser::diagnosis
