// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/inference/diagnose.hpp"
#include "diagnosis/models/sphere.hpp"

namespace grouser::diagnosis {
namespace {

/// A fall as the baseline has it, so many samples with noise over the range, recorded as a gap.
SeriesRecording fall(int samples, double noise, double stated, int conditions) {
  SeriesRecording r;
  r.name = "fall";
  r.channels.resize(1);
  r.channels[0].name = "gap";
  r.channels[0].noise_sd = stated;
  const auto value = [](Setting setting, double mean, double sd) {
    KnownValue known;
    known.setting = setting;
    known.value = mean;
    known.uncertainty = sd;
    return known;
  };
  r.values = {value(Setting::kDiameter, 0.01, 3e-5), value(Setting::kParticleDensity, 2000.0, 6.0),
              value(Setting::kFluidDensity, 1000.0, 0.0), value(Setting::kViscosity, 0.3, 0.005),
              value(Setting::kReleaseGap, 0.08, 8e-4)};
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  for (int k = 0; k < conditions; ++k) {
    Condition c;
    c.name = std::string(1, static_cast<char>('A' + k));
    for (int i = 0; i < samples; ++i) c.times.push_back(0.5 * i / samples);
    Settings s;
    for (const KnownValue& known : r.values) s[known.setting] = known.value;
    s[Setting::kDragInertia] = 1.0;
    c.samples = {make_sphere_model({c.times, {Signal::kGap}})->run(s, {})};
    for (double& gap : c.samples[0]) gap += noise * 0.08 * normal(random);
    r.conditions.push_back(c);
  }
  return r;
}

bool is_flagged(const Diagnosis& d, const std::string& text) {
  for (const std::string& flag : d.flags)
    if (flag.find(text) != std::string::npos) return true;
  return false;
}

TEST(WeakData, ASeriesWithoutAnyNoiseRaisesNoAlarm) {
  EXPECT_EQ(diagnose(fall(200, 0.0, 0.0, 1), default_baseline()).word, Word::kNoMismatch);
}

TEST(WeakData, FewSamplesWithoutStatedNoiseAreSaidAndNothingIsNamed) {
  const Diagnosis d = diagnose(fall(12, 1e-3, 0.0, 2), default_baseline());
  EXPECT_TRUE(is_flagged(d, "no stated noise"));
  EXPECT_NE(d.word, Word::kNamed);
}

TEST(WeakData, OneRecordingIsSaidToBeOne) {
  EXPECT_TRUE(is_flagged(diagnose(fall(100, 1e-3, 8e-5, 1), default_baseline()), "one fitted"));
}

TEST(WeakData, ASphereThatNeverMovesIsNoNamedCause) {
  SeriesRecording r = fall(100, 1e-3, 8e-5, 2);
  for (Condition& c : r.conditions)
    for (double& gap : c.samples[0]) gap = 0.08 + (gap > 0.04 ? 1e-5 : -1e-5);
  const Diagnosis d = diagnose(r, default_baseline());
  EXPECT_NE(d.word, Word::kNoMismatch);
  for (const double value : {d.probability, d.detection.p}) EXPECT_TRUE(std::isfinite(value));
  EXPECT_TRUE(d.cause == "unknown" || d.word == Word::kProvisional) << d.cause;
}

}  // namespace
}  // namespace grouser::diagnosis
