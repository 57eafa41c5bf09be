// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "diagnosis/recordings/recording.hpp"

namespace grouser::diagnosis {

/// What a look at the data alone says about a sensor or a file, before any simulation.
struct Finding {
  std::string condition;
  std::string channel;  ///< "" = the condition as a whole
  std::string kind;     ///< word, such as `clipping`
  int line = 0;         ///< in the condition's CSV, 0 = none in particular
  std::string text;     ///< one sentence with numbers
  /// Whether it is against the recording's word (a fault), not merely worth knowing.
  bool is_fault = false;
};

/// Missing rows, plateaus of a clipped sensor, and position against speed: their ratio of scale and
/// the lag of one behind the other, each against its own standard error. Local.
std::vector<Finding> admit(const SeriesRecording& recording);

/// Position and speed of one condition compared: integral of the speed against the gap.
struct Consistency {
  double gain = 1.0;        ///< change of the gap over that of the integrated speed
  double gain_error = 0.0;  ///< standard error
  double lag = 0.0;         ///< of the speed behind the gap [s]
  double lag_error = 0.0;
};

/// @param speed downward positive [m s-1] @param gap [m]
/// @param gap_noise_sd of the gap [m]; the speed's noise is small after integration and neglected
/// Local.
Consistency compare_gap_and_speed(const std::vector<double>& times, const std::vector<double>& gap,
                                  const std::vector<double>& speed, double gap_noise_sd);

}  // namespace grouser::diagnosis
