// SPDX-License-Identifier: BSD-3-Clause
#include "engine/app/breakdown.hpp"

#include <cmath>

#include "base/time_step.hpp"
#include "base/units.hpp"

namespace grouser {
namespace {

std::string text_of(const Vec3& v, const char* unit) {
  std::string text;
  for (const double x : {v.x, v.y, v.z}) text.append(text.empty() ? "(" : " ").append(rounded(x));
  return text.append(") ").append(unit);
}

std::string step_text(const Case& input) {
  return "the time step " + rounded(time_step_of(input)) + " s, " +
         rounded(time_step_of(input) / rayleigh_time(input)) + " of the Rayleigh time";
}

constexpr const char* kShorterStep =
    "leave numerics.time_step out or lower rayleigh_fraction, and look at speeds and loads";

std::string not_a_number(const World& world, const Case& input) {
  const World::Culprit grain = world.culprit(Fault::kNotANumber);
  return "a force or velocity is not a number: grain " + std::to_string(grain.id) +
         ", which started at " + text_of(grain.origin, "m") +
         "; two grains at one place, a force " + "beyond all numbers, or " + step_text(input) +
         ", may do that: " + kShorterStep;
}

std::string lost(const World& world, const Case& input) {
  const World::Culprit grain = world.culprit(Fault::kLostParticle);
  const double way = norm(grain.velocity) * time_step_of(input);
  // So fast that it does not matter where it went.
  const std::string cause =
      way > 1.0
          ? "; " + rounded(way) +
                " m in one step: find what throws it, such as a torque too large "
                "for the inertia of the wheel, or shorten the time step"
          : "; where it went over a wall use a higher box.depth or a slower wheel, where it went "
            "through one a shorter time step or stiffer box.solid";
  return "a grain has left the box: grain " + std::to_string(grain.id) + " is at " +
         text_of(grain.position, "m") + " with " + text_of(grain.velocity, "m/s") + cause;
}

std::string too_deep(const World& world, const World::StepResult& result, const Case& input) {
  const World::Deepest pair = world.deepest();
  const std::string other =
      pair.second >= 0 ? "grain " + std::to_string(pair.second)
                       : "the " + world.body(static_cast<std::size_t>(-1 - pair.second)).name;
  return "overlap " + rounded(result.max_overlap) + " of a radius is over numerics.max_overlap " +
         rounded(input.numerics.max_overlap) + ": grain " + std::to_string(pair.first) + " at " +
         text_of(pair.position, "m") + " and " + other +
         "; use stiffer grains (young_modulus, stiffness_scale), slower or lighter bodies, or " +
         "where only few chains press so hard a higher limit";
}

std::string too_fast(const World::StepResult& result, double radius, const Case& input) {
  return "a grain moves at " + rounded(result.fastest) + " m/s, " +
         rounded(result.fastest * time_step_of(input)) +
         " m in a step: more than the radius of the smallest grain, " + rounded(radius) +
         " m, so that it may pass a surface unseen; shorten " + step_text(input) +
         ", or find what throws it";
}

}  // namespace

std::optional<std::string> breakdown_of(const World& world, const World::StepResult& result,
                                        const Case& input) {
  if (result.fault == Fault::kNotANumber) return not_a_number(world, input);
  if (result.fault == Fault::kLostParticle) return lost(world, input);
  if (result.max_overlap > input.numerics.max_overlap) return too_deep(world, result, input);
  if (input.grains.size_curve.empty()) return std::nullopt;
  const double radius =
      0.5 * input.grains.size_curve.front().diameter * input.grains.coarse_graining;
  if (result.fastest * world.settings().time_step > radius) return too_fast(result, radius, input);
  return std::nullopt;
}

std::optional<std::string> breakdown_of(const ResolvedFlow& fluid) {
  // At a Mach number of 1 the equilibrium has negative populations.
  constexpr double kMostMachOfACell = 1.0;
  const FlowTotals totals = fluid.flow().totals();
  const double mach = std::sqrt(3.0) * totals.max_speed_lu;
  if (totals.finite && mach < kMostMachOfACell) return std::nullopt;
  const std::string what = totals.finite
                               ? "the fluid moves at " +
                                     rounded(fluid.scale().units.velocity(totals.max_speed_lu)) +
                                     " m/s somewhere, a Mach number of " + rounded(mach)
                               : "the fluid's density or velocity is not a number";
  return what + "; the relaxation time is " + rounded(fluid.scale().relaxation_time) +
         ", the grid Reynolds number " + rounded(fluid.scale().grid_reynolds) +
         " at fluid.lattice.speed: give smaller cells, a lower mach, or the speed that there "
         "really "
         "is";
}

std::string heating_text(const EnergyLedger& ledger, const World::Survey& survey,
                         const Case& input) {
  return "the grains gain energy that nothing gives them: " + rounded(ledger.rise()) +
         " J have come from nothing, their kinetic energy is " + rounded(survey.kinetic) +
         " J; contacts do so when a step is too long for them: shorten " + step_text(input) + " (" +
         kShorterStep + ")";
}

}  // namespace grouser
