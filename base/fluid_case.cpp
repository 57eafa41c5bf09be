// SPDX-License-Identifier: BSD-3-Clause
#include "base/fluid_case.hpp"

#include <vector>

namespace grouser {
namespace {

// @param laws names in the order of the engine's list; none for a term that has but one
void describe_term(FieldVisitor& v, const Field& field, TermCase& term,
                   const std::vector<std::string>& laws) {
  v.group(field, [&](FieldVisitor& inner) {
    if (!laws.empty()) inner.word({"law", "which law", kOptional}, term.law, laws);
    inner.quantity({"amplitude", "0 = off, 1 = as published", kOptional}, term.amplitude, "1",
                   Range::closed(0.0, 1e3));
  });
}

void describe_lubrication(FieldVisitor& v, FluidCase& f) {
  v.group({"lubrication", "film between a grain and the walls of the box", kOptional},
          [&](FieldVisitor& inner) {
            TermCase& term = f.lubrication;
            inner.word({"law", "which law", kOptional}, term.law, {"brenner", "leading"});
            inner.quantity({"amplitude", "0 = off, 1 = as published", kOptional}, term.amplitude,
                           "1", Range::closed(0.0, 1e3));
            inner.quantity(
                {"smallest_gap", "roughness over the radius; the film is no thinner", kOptional},
                f.smallest_gap, "1", Range::above_up_to(0.0, 1.0));
            inner.quantity({"cutoff_gap", "gap over the radius beyond which there is no film force",
                            kOptional},
                           f.cutoff_gap, "1", Range::above_up_to(0.0, 1e3));
            inner.rule("cutoff_gap", f.cutoff_gap > f.smallest_gap, "is not above the smallest gap",
                       "the film acts between the two");
          });
}

void describe_wall(FieldVisitor& v, FluidCase& f) {
  v.group({"wall", "what the container's walls add to the drag", kOptional},
          [&](FieldVisitor& inner) {
            inner.word({"law", "which law", kOptional}, f.wall.law,
                       {"none", "faxen", "haberman_sayre", "di_felice"});
            inner.quantity({"amplitude", "0 = off, 1 = as published", kOptional}, f.wall.amplitude,
                           "1", Range::closed(0.0, 1.0));
            inner.quantity(
                {"diameter", "inner diameter of the container, or side of a square one", kOptional},
                f.wall_diameter, "m", Range::not_negative());
            inner.rule("diameter", f.wall.law == "none" || f.wall_diameter > 0.0,
                       "is needed for law " + f.wall.law, "give the container's inner diameter");
          });
}

}  // namespace

void describe(FieldVisitor& v, FluidCase& f) {
  v.word({"mode",
          "submerged: the fluid moves grains, they do not move it; resolved: both, on a lattice",
          kOptional},
         f.mode, {"submerged", "resolved"});
  v.quantity({"density", "density of the fluid"}, f.density, "kg m-3", Range::positive());
  v.quantity({"viscosity", "dynamic viscosity"}, f.viscosity, "Pa s", Range::positive());
  v.optional_group({"lattice", "cells that the fluid is computed on, for mode resolved", kOptional},
                   f.has_lattice, [&](FieldVisitor& inner) { describe(inner, f.lattice); });
  v.quantity({"velocity_x", "of the undisturbed fluid, at the floor; on a lattice, at the start",
              kOptional},
             f.velocity_x, "m s-1", Range::any());
  v.quantity({"velocity_y", "of the undisturbed fluid", kOptional}, f.velocity_y, "m s-1",
             Range::any());
  v.quantity({"velocity_z", "of the undisturbed fluid", kOptional}, f.velocity_z, "m s-1",
             Range::any());
  v.quantity({"shear_rate", "rise of velocity_x over the height", kOptional}, f.shear_rate, "s-1",
             Range::any());
  v.quantity(
      {"void_fraction", "of the fluid around every grain, for drag laws of crowds", kOptional},
      f.void_fraction, "1", Range::closed(0.3, 1.0));
  describe_term(v, {"drag", "drag", kOptional}, f.drag,
                {"schiller_naumann", "stokes", "dallavalle", "brown_lawler", "abraham", "di_felice",
                 "di_felice_brown_lawler", "gidaspow", "wen_yu", "koch_hill", "beetstra"});
  describe_term(v, {"buoyancy", "pressure of the fluid at rest", kOptional}, f.buoyancy, {});
  describe_term(v, {"added_mass", "fluid that is accelerated with a grain", kOptional},
                f.added_mass, {"sphere", "zuber"});
  describe_term(v, {"history", "drag of past changes of speed", kOptional}, f.history,
                {"basset", "mei_adrian"});
  describe_term(v, {"shear_lift", "lift in sheared fluid", kOptional}, f.shear_lift,
                {"saffman_mei", "saffman"});
  describe_term(v, {"spin_lift", "lift of a spinning grain", kOptional}, f.spin_lift,
                {"rubinow_keller", "oesterle"});
  describe_term(v, {"spin_drag", "torque on a spinning grain", kOptional}, f.spin_drag,
                {"kirchhoff", "dennis"});
  describe_lubrication(v, f);
  describe_wall(v, f);
}

double drag_time(const FluidCase& fluid, double diameter, double density) {
  const double added = 0.5 * fluid.added_mass.amplitude * fluid.density;
  return (density + added) * diameter * diameter / (18.0 * fluid.viscosity);
}

}  // namespace grouser
