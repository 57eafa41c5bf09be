// SPDX-License-Identifier: BSD-3-Clause
#include "base/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "base/lattice_units.hpp"
#include "base/size_curve.hpp"
#include "base/units.hpp"

namespace grouser {
namespace {

double to_four_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3e", value);
  return std::strtod(text, nullptr);
}

double smallest_radius(const GrainsCase& grains) {
  return 0.5 * grains.size_curve.front().diameter * grains.coarse_graining;
}

// Of the loose column that a bed is poured as: one cell of the largest grain's size to each grain.
double loose_height(const Case& c) {
  const SizeCurve sizes(c.grains);
  const double largest = sizes.largest();
  const auto fit = [&](double room) { return std::max(1.0, std::floor(room / largest)); };
  return std::ceil(grain_count(c) / (fit(c.box.length) * fit(c.box.width))) * largest;
}

// Of placed grains that fall freely to the floor.
double fastest_placed(const Case& c) {
  double fastest2 = 0.0;
  for (const PlacedGrain& g : c.placed.grains)
    fastest2 = std::max(fastest2, g.velocity_x * g.velocity_x + g.velocity_y * g.velocity_y +
                                      g.velocity_z * g.velocity_z + 2.0 * c.gravity * g.z);
  return std::sqrt(fastest2);
}

double rim_speed(const WheelCase& wheel) {
  if (wheel.drive == "rim_speed") return std::abs(wheel.rim_speed);
  if (wheel.drive == "slip") return wheel.forward_speed / (1.0 - wheel.slip);
  return wheel.forward_speed;  // of a rolling wheel; what a torque does to it is not known before
}

// Three years where a run does a hundred thousand in a second, which few do.
constexpr double kMostSteps = 1e13;

// The case itself and the bed it starts from.
std::vector<Case> with_bed(const Case& input) {
  if (!input.has_wheel) return {input};
  return {input, bed_case(input)};
}

std::string collision_text(const Impact& collision) {
  return rounded(collision.time) + " s (" + collision.pair + " at " + rounded(collision.speed) +
         " m/s)";
}

Impact worst_collision(const Case& input) {
  Impact worst;
  for (const Case& one : with_bed(input)) {
    const Impact collision = shortest_collision(one);
    if (worst.pair.empty() || collision.time < worst.time) worst = collision;
  }
  return worst;
}

}  // namespace

double rayleigh_time(const Case& input) {
  const GrainsCase& grains = input.grains;
  if (grains.size_curve.empty()) return 0.0;
  const double nu = grains.solid.poisson_ratio;
  const double shear =
      input.contact.stiffness_scale * grains.solid.young_modulus / (2.0 * (1.0 + nu));
  return std::numbers::pi * smallest_radius(grains) * std::sqrt(grains.density / shear) /
         (0.1631 * nu + 0.8766);
}

double fastest_speed(const Case& input) {
  if (input.has_wheel) return input.wheel.forward_speed + rim_speed(input.wheel);
  if (input.grains.size_curve.empty()) return 0.0;
  if (input.has_placed) return fastest_placed(input);
  return std::sqrt(2.0 * input.gravity * loose_height(input));
}

Impact shortest_collision(const Case& input) {
  Impact shortest;
  if (input.grains.size_curve.empty()) return shortest;
  shortest.speed = fastest_speed(input);
  const double r = smallest_radius(input.grains);
  const double mass = input.grains.density * 4.0 / 3.0 * std::numbers::pi * r * r * r;
  const auto softness = [&](const SolidCase& s) {
    return (1.0 - s.poisson_ratio * s.poisson_ratio) /
           (input.contact.stiffness_scale * s.young_modulus);
  };
  const auto meet = [&](const char* pair, const SolidCase& other, double m, double radius) {
    const double stiffness = 1.0 / (softness(input.grains.solid) + softness(other));
    const double v = shortest.speed;
    const double time = 2.87 * std::pow(m * m / (radius * stiffness * stiffness * v), 0.2);
    const double overlap =
        std::pow(15.0 * m * v * v / (16.0 * std::sqrt(radius) * stiffness), 0.4) / r;
    shortest.overlap = std::max(shortest.overlap, overlap);
    if (!shortest.pair.empty() && time >= shortest.time) return;
    shortest.pair = pair;
    shortest.time = time;
  };
  meet("two grains", input.grains.solid, 0.5 * mass, 0.5 * r);
  meet("a grain and the box", input.box.solid, mass, r);
  if (input.has_wheel) meet("a grain and the wheel", input.wheel.solid, mass, r);
  shortest.time = to_four_digits(shortest.time);
  return shortest;
}

double collision_steps(const Case& input) {
  const ContactCase& contact = input.contact;
  double restitution = std::min(contact.grain_grain.restitution, contact.grain_box.restitution);
  if (input.has_wheel) restitution = std::min(restitution, contact.grain_wheel.restitution);
  return std::max(8.0, std::ceil(1.8 * std::pow(restitution, -0.6)));
}

double longest_time_step(const Case& input) {
  if (input.numerics.time_step > 0.0) return input.numerics.time_step;
  return std::min(input.numerics.rayleigh_fraction * rayleigh_time(input),
                  shortest_collision(input).time / collision_steps(input));
}

double time_step_of(const Case& input) {
  const double longest = longest_time_step(input);
  if (!has_lattice(input)) return longest;
  const LatticeScale scale = lattice_scale(input, longest);
  const double part = scale.units.step / static_cast<double>(scale.substeps);
  return std::isnormal(part) && part > 0.0 ? part : longest;  // a refused lattice comes to nothing
}

bool is_step_of_collision(const Case& input) {
  return input.numerics.time_step <= 0.0 &&
         longest_time_step(input) < input.numerics.rayleigh_fraction * rayleigh_time(input);
}

std::string time_step_text(const Case& input) {
  const double step = time_step_of(input);
  const double rayleigh = rayleigh_time(input);
  const Impact collision = shortest_collision(input);
  const std::string decided = input.numerics.time_step > 0.0 ? "numerics.time_step"
                              : is_step_of_collision(input)  ? "the shortest collision"
                                                             : "the Rayleigh time";
  const std::string divided =
      has_lattice(input) ? " and the lattice, of whose step it is a part" : "";
  return "time step " + rounded(step) + " s, decided by " + decided + divided + ": " +
         rounded(step / rayleigh) + " of the Rayleigh time " + rounded(rayleigh) + " s, " +
         rounded(step / collision.time) + " of the shortest collision " + collision_text(collision);
}

void describe_time_step(FieldVisitor& v, const Case& input) {
  const double step = input.numerics.time_step;
  const double rayleigh = rayleigh_time(input);
  const std::string leave_out = "leave it out: it is then rayleigh_fraction of that time";
  v.rule("numerics.time_step", step <= rayleigh,
         "is " + rounded(step) + " s, over the Rayleigh time of the smallest grain, " +
             rounded(rayleigh) + " s: contacts would gain energy until the run breaks down",
         "give " + rounded(kSoundRayleighShare * rayleigh) + " s or less, or " + leave_out);
  const Impact collision = worst_collision(input);
  v.rule(
      "numerics.time_step", step <= collision.time,
      "is " + rounded(step) + " s, longer than the shortest collision, " +
          collision_text(collision) + ": grains would pass through each other",
      "give " + rounded(collision.time / collision_steps(input)) + " s or less, or leave it out");
  for (const Case& one : with_bed(input)) {
    const Impact meeting = shortest_collision(one);
    const bool is_number = std::isnormal(rayleigh) && std::isnormal(meeting.time);
    v.rule("grains", is_number, "come to a time step of " + rounded(time_step_of(one)) + " s",
           "look at the units of density, young_modulus and diameters");
    v.rule(one.has_wheel ? "wheel" : "grains", !is_number || meeting.overlap < 1.0,
           "grains that meet at " + rounded(meeting.speed) + " m/s would overlap by " +
               rounded(meeting.overlap) + " of the smallest radius, so the run would break down",
           one.has_wheel ? "look at the units of speeds, density and young_modulus"
                         : "the speed is that of free fall through the filling; look at the "
                           "units of gravity, box, density and young_modulus");
    const bool settles = !one.has_wheel && !one.has_placed;
    const double time = settles ? one.bed.settle_limit : run_duration(one);
    const double steps = time / time_step_of(one);
    v.rule("numerics", !is_number || steps <= kMostSteps,
           "comes to " + rounded(steps) + " time steps of " + rounded(time_step_of(one)) + " s",
           "over " + rounded(kMostSteps) + " no machine ends; look at the units of diameters, " +
               "density, young_modulus, travel and time_step");
  }
}

std::vector<Problem> time_step_warnings(const YamlNode& node, const Case& input) {
  const bool is_given = input.numerics.time_step > 0.0;
  const std::string key = is_given ? "numerics.time_step" : "numerics.rayleigh_fraction";
  const YamlNode* at = node.find_path(key);
  if (at == nullptr) at = &node;
  std::vector<Problem> warnings;
  const auto warn = [&](double share, double sound, const std::string& of) {
    if (share > sound)
      warnings.push_back({at->file, at->line, at->column, key,
                          "makes the time step " + rounded(share) + " of " + of,
                          "over " + rounded(sound) + " of it contacts may gain energy"});
  };
  const double rayleigh = rayleigh_time(input);
  warn(time_step_of(input) / rayleigh, kSoundRayleighShare,
       "the Rayleigh time of the smallest grain, " + rounded(rayleigh) + " s");
  if (!is_given) return warnings;
  const Impact collision = worst_collision(input);
  warn(time_step_of(input) / collision.time, 1.0 / (kSoundStepShare * collision_steps(input)),
       "the shortest collision, " + collision_text(collision));
  return warnings;
}

}  // namespace grouser
