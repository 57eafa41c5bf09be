// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "diagnosis/recordings/settings.hpp"

namespace grouser::diagnosis {

enum class Family { kBaseline, kPhysics, kSensor, kParameter, kNumerics, kImitator, kUnknown };

/// In what a prior's mean and spread are counted: SI, or a size of the recording at hand.
enum class Scale {
  kAbsolute,
  kSpeed,     ///< range of the gap over the duration
  kDuration,  ///< of the motion
  kRange,     ///< of the channel
  kRate,      ///< the channel's range over the duration
  kInterval,  ///< between samples
};

/// A setting that a hypothesis sets free, with its prior: normal, or log-normal about `mean` with
/// `sd` of the logarithm.
struct FreeSetting {
  Setting setting = Setting::kDiameter;
  double mean = 0.0;
  double sd = 0.0;
  Scale scale = Scale::kAbsolute;
  bool is_log = false;
  bool is_positive = false;  ///< half a normal: only values above 0
};

/// One line of explanation each, for `grouser diagnose explain`.
struct Explanation {
  const char* where;     ///< in the recording it shows
  const char* scaling;   ///< how it grows with size, speed, liquid
  const char* confuser;  ///< what looks alike
  const char* breaker;   ///< the cheapest observation that tells them apart
};

/// One possible cause of a mismatch: settings that it frees on top of the baseline's own.
struct Hypothesis {
  const char* id;
  Family family;
  const char* title;
  std::array<FreeSetting, 3> free{};  ///< the first `count` are used
  std::size_t count = 0;
  /// kParameter: the baseline's own setting whose prior is widened instead.
  Setting widened = Setting::kDiameter;
  Explanation explanation{};

  /// Whether amplitude 1 is textbook theory.
  bool has_theory() const { return family == Family::kPhysics; }
};

/// Prior of the amplitude of a term that theory knows: it may be off by a quarter.
constexpr FreeSetting theory(Setting setting) { return {setting, 1.0, 0.25}; }

const char* word_of(Family family);

}  // namespace grouser::diagnosis
