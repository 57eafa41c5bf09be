// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/hypotheses/hypothesis.hpp"
#include "diagnosis/models/model.hpp"
#include "diagnosis/recordings/noise.hpp"
#include "diagnosis/recordings/recording.hpp"

namespace grouser::diagnosis {

/// One unknown in units of its own prior: value = mean + sd p, or mean exp(sd p), with p ~ N(0, 1).
struct Coordinate {
  std::string label;
  Setting setting = Setting::kDiameter;
  int channel = -1;                     ///< of a sensor's setting
  int knot = -1;                        ///< of the latent force, whose `setting` is not used
  std::vector<std::size_t> conditions;  ///< that it acts on
  double mean = 0.0;
  double sd = 1.0;
  bool is_log = false;
  bool is_positive = false;  ///< p >= 0, with the prior's half

  double value(double p) const;
};
using Coordinates = std::vector<Coordinate>;

/// One condition as the inference sees it: averaged to at most a few hundred samples.
struct Observed {
  std::string name;
  std::unique_ptr<Model> model;
  Settings known;  ///< settings at the means of what is known, sensors without fault
  std::vector<double> times;
  std::vector<std::vector<double>> samples;  ///< per channel, SI
  std::vector<NoiseModel> noise;             ///< per channel
  /// Per channel, 1 where the curve is smooth and less at its jumps and kinks (impacts), where what
  /// a sensor shows depends on when within its interval it looked. From the data alone, so that all
  /// causes are measured alike.
  std::vector<std::vector<double>> weights;
  std::vector<double> stated;  ///< noise per channel as the recording says, or 0
  double release = 0.0;        ///< expected time of release
  std::size_t first = 0;       ///< row of its first sample in stacked vectors
};

/// Terms that the baseline has on, by setting: amplitude 0 or 1.
using Terms = SettingValues;

/// A set of conditions, what is known of them, and the unknowns that any model has.
class Study {
 public:
  /// @param held_out whether the conditions that may not be fitted are taken instead
  Study(const SeriesRecording& recording, const Terms& terms, bool held_out = false);

  const std::vector<Observed>& observed() const { return observed_; }
  std::vector<Observed>& observed() { return observed_; }
  const std::vector<Signal>& channels() const { return channels_; }
  const Coordinates& baseline() const { return baseline_; }
  std::size_t rows() const { return rows_; }
  const Terms& terms() const { return terms_; }

  /// Coordinates of the baseline and of `hypothesis`. @param channel of a sensor's hypothesis
  Coordinates with(const Hypothesis& hypothesis, int channel) const;
  /// Coordinates of the baseline and a latent force with so many knots per condition.
  Coordinates with_latent(int knots, double sd) const;

  /// Predicted samples of one condition, channels one after the other. Local.
  std::vector<double> predict(std::size_t condition, const Coordinates& coordinates,
                              const Eigen::VectorXd& p) const;
  Settings settings_of(std::size_t condition, const Coordinates& coordinates,
                       const Eigen::VectorXd& p) const;
  /// Recorded minus predicted, whitened, of one condition, put into `out` at its rows.
  void residual(std::size_t condition, const std::vector<double>& predicted,
                Eigen::VectorXd& out) const;
  /// Whitens values that are stacked as predicted samples, in place.
  void whiten(std::size_t condition, double* values) const;
  /// Whether the recorded curves jump anywhere.
  bool has_impacts() const;
  /// Residuals are smoothed over so many samples (1 = not) and the weights left out: where a jump
  /// is a little early or late, a smoothed residual tells which way, a sharp one does not.
  void set_smoothing(std::size_t width) const { smoothing_ = width; }

  /// Where fits begin: the priors' means, and the releases where the curves begin to move.
  Eigen::VectorXd start(const Coordinates& coordinates) const;
  /// Finds the releases: within three deviations of what is stated, the one at which the first
  /// part of the recorded curves is most like the predicted.
  void align();

  double scale_of(Scale scale, int channel) const;
  double duration_of(std::size_t condition) const;
  long runs() const { return runs_; }

 private:
  void add_baseline(const SeriesRecording& recording,
                    const std::vector<const Condition*>& conditions);
  std::vector<Observed> observed_;
  std::vector<Signal> channels_;
  Coordinates baseline_;
  Eigen::VectorXd start_;  ///< of the baseline's coordinates
  Terms terms_;
  std::size_t rows_ = 0;
  mutable long runs_ = 0;
  mutable std::size_t smoothing_ = 1;
};

}  // namespace grouser::diagnosis
