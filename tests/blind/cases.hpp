// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <string>
#include <vector>

#include "tests/blind/world.hpp"

namespace blind {

// One channel's fault; the same in all runs of a case.
struct Sensor {
  double gain = 0.0;
  double offset = 0.0;
  double lag = 0.0;
  double creep = 0.0;  // per second
};

struct Run {
  std::string name;
  bool is_held_out = false;
  World real;      // what happens
  World innocent;  // the same without the secret
  World told;      // what the recording says
  double interval = 0.0;
  int samples = 0;
  std::vector<std::vector<double>> clean;  // per channel, secret and sensor fault included
  std::vector<std::vector<double>> plain;  // per channel, without the secret
  std::vector<double> noise;               // one standard deviation per channel
  std::vector<bool> mask;  // samples where the secret is above a quarter of its peak
};

struct Case {
  std::string kind;  // null, single, double, unlisted
  std::vector<std::string> secrets;
  std::string regime;       // `creeping` or `inertial`, by the first run's Reynolds number
  double amplitude = 0.0;   // of the first secret where theory has 1, else 0
  double visibility = 0.0;  // of the secret after the parameters took their part [standard errors]
  bool knows_inertia = false;
  bool knows_virtual_mass = false;
  int sensor_channel = -1;
  Sensor sensor;
  bool has_speed = false;
  double correlation = 0.0;
  double stated = 1.0;  // stated noise over the real one
  std::vector<Run> runs;
};

// Draws a case whose secrets can be seen; `kind` and `secrets` are given.
Case draw_case(const std::string& kind, const std::vector<std::string>& secrets, bool is_poor,
               std::mt19937_64& random);

// Names that may be concealed alone, and those of no catalogue.
const std::vector<std::string>& listed_secrets();
const std::vector<std::string>& unlisted_secrets();

}  // namespace blind
