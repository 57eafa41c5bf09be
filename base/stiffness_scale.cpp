// SPDX-License-Identifier: BSD-3-Clause
#include "base/stiffness_scale.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/time_step.hpp"
#include "base/units.hpp"

namespace grouser {
namespace {

constexpr double kContactsPerGrain = 6.0;

}  // namespace

ExpectedOverlap expected_overlap(const Case& input) {
  ExpectedOverlap out;
  out.pressure = input.grains.density * input.bed.solid_fraction * input.gravity * input.bed.depth;
  const WheelCase& wheel = input.wheel;
  if (input.has_wheel)
    out.pressure = std::max(out.pressure, wheel.load / (wheel.width * 0.25 * wheel.diameter));
  const double nu = input.grains.solid.poisson_ratio;
  const double stiffness =
      input.contact.stiffness_scale * input.grains.solid.young_modulus / (2.0 * (1.0 - nu * nu));
  // F = pi d^2 p / (Z phi) and F = 4/3 E* sqrt(d/4) overlap^(3/2).
  out.overlap = 2.0 * std::pow(1.5 * std::numbers::pi * out.pressure /
                                   (kContactsPerGrain * input.bed.solid_fraction * stiffness),
                               2.0 / 3.0);
  return out;
}

std::vector<Problem> stiffness_warnings(const YamlNode& node, const Case& input) {
  const double scale = input.contact.stiffness_scale;
  if (scale >= 1.0) return {};
  const std::string key = "contact.stiffness_scale";
  const YamlNode* at = node.find_path(key);
  if (at == nullptr) at = &node;
  Case true_case = input;
  true_case.contact.stiffness_scale = 1.0;
  const ExpectedOverlap expected = expected_overlap(input);
  return {{at->file, at->line, at->column, key,
           "makes every contact " + rounded(scale) + " as stiff as its solids: time step " +
               rounded(time_step_of(input)) + " s instead of " + rounded(time_step_of(true_case)) +
               " s, mean overlap about " + rounded(expected.overlap) + " of a radius instead of " +
               rounded(expected_overlap(true_case).overlap) + " under " +
               rounded(1e-3 * expected.pressure) + " kPa",
           "compare with the mean_overlap of the outcome, the max_overlap of series.csv and with a "
           "stiffer run"}};
}

}  // namespace grouser
