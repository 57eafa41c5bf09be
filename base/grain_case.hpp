// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/schema.hpp"

namespace grouser {

/// One grain, put where it is wanted.
struct PlacedGrain {
  double diameter = 0.0;  ///< [m]
  double x = 0.0;         ///< of the centre [m]
  double y = 0.0;
  double z = 0.0;
  double velocity_x = 0.0;  ///< [m s-1]
  double velocity_y = 0.0;
  double velocity_z = 0.0;
  double spin_x = 0.0;  ///< [rad s-1]
  double spin_y = 0.0;
  double spin_z = 0.0;
};

/// Grains placed one by one instead of a bed poured at random.
struct PlacedCase {
  double duration = 0.0;  ///< of the run [s]
  std::vector<PlacedGrain> grains;

  double smallest() const;  ///< diameter [m]
  double largest() const;   ///< diameter [m]
};

/// A force on one grain over time or over a state of the grain: a hat that rises in a straight line
/// from 0 at `from` to its height at `peak` and falls to 0 at `to`.
struct ProbeCase {
  std::int64_t grain = 0;      ///< its number, from 0
  std::string axis = "z";      ///< along which it acts
  std::string along = "time";  ///< what from, peak and to are of; see unit_of_probe
  double from = 0.0;
  double peak = 0.0;
  double to = 0.0;
  double force = 0.0;  ///< at the peak [N]

  /// Force where the variable has this value [N].
  double at(double value) const;
};

/// Unit of the variable `along`: "time" s, "gap" m (lowest point over the floor), "speed" m s-1,
/// "reynolds" 1 (of the grain in the fluid). Local.
const char* unit_of_probe(const std::string& along);

/// A grain whose motion and forces are written to track.csv.
struct TrackCase {
  std::int64_t grain = 0;
  double interval = 1e-3;  ///< simulated time between rows [s]
};

/// See FieldVisitor.
void describe(FieldVisitor& visitor, PlacedCase& placed);
void describe(FieldVisitor& visitor, ProbeCase& probe);
void describe(FieldVisitor& visitor, TrackCase& track);

}  // namespace grouser
