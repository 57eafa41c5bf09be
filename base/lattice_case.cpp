// SPDX-License-Identifier: BSD-3-Clause
#include "base/lattice_case.hpp"

namespace grouser {
namespace {

void describe_face(FieldVisitor& v, LatticeFaceCase& face) {
  v.word({"kind", "what is there", kOptional}, face.kind,
         {"wall", "slip", "periodic", "velocity", "pressure", "outflow"});
  v.quantity({"velocity_x", "of a wall along itself, or of the fluid at kind velocity", kOptional},
             face.velocity_x, "m s-1", Range::any());
  v.quantity({"velocity_y", "likewise", kOptional}, face.velocity_y, "m s-1", Range::any());
  v.quantity({"velocity_z", "likewise", kOptional}, face.velocity_z, "m s-1", Range::any());
  v.quantity({"pressure", "beyond that of the fluid at rest, at kind pressure", kOptional},
             face.pressure, "Pa", Range::any());
}

}  // namespace

void describe(FieldVisitor& v, LatticeCase& l) {
  v.quantity({"cell", "side of a cell; must divide box and height"}, l.cell, "m",
             Range::positive());
  v.quantity({"height", "of the fluid over the floor; 0 = box.depth", kOptional}, l.height, "m",
             Range::not_negative());
  v.quantity({"speed",
              "largest that is expected of fluid or grains; needed without "
              "relaxation_time",
              kOptional},
             l.speed, "m s-1", Range::not_negative());
  v.quantity({"mach", "Mach number of that speed; sets the lattice's step", kOptional}, l.mach, "1",
             Range::above_up_to(0.0, 0.3));
  v.quantity(
      {"relaxation_time", "sets the lattice's step instead; 0 = from speed and mach", kOptional},
      l.relaxation_time, "1", Range::not_negative());
  v.word({"velocities", "set of velocities", kOptional}, l.velocities, {"D3Q15", "D3Q19", "D3Q27"});
  v.word({"collision", "how populations relax", kOptional}, l.collision,
         {"bgk", "trt", "mrt", "les"});
  v.word({"precision", "of populations in memory and arithmetic", kOptional}, l.precision,
         {"double", "single"});
  v.quantity({"smagorinsky", "constant of the eddy viscosity, for collision les", kOptional},
             l.smagorinsky, "1", Range::closed(0.0, 1.0));
  v.quantity({"acceleration_x", "body force over density, which drives the fluid", kOptional},
             l.acceleration_x, "m s-2", Range::any());
  v.quantity({"acceleration_y", "likewise", kOptional}, l.acceleration_y, "m s-2", Range::any());
  v.quantity({"acceleration_z", "likewise; gravity is not to be given here", kOptional},
             l.acceleration_z, "m s-2", Range::any());
  v.group({"faces", "what the fluid meets at the six sides; walls without", kOptional},
          [&](FieldVisitor& inner) {
            for (std::size_t side = 0; side < kLatticeFaces.size(); ++side)
              inner.group({kLatticeFaces[side], "this side", kOptional},
                          [&](FieldVisitor& face) { describe_face(face, l.faces[side]); });
            for (std::size_t axis = 0; axis < 3; ++axis)
              inner.rule(kLatticeFaces[2 * axis],
                         (l.faces[2 * axis].kind == "periodic") ==
                             (l.faces[2 * axis + 1].kind == "periodic"),
                         "and the other end of the axis are not both periodic",
                         "make both ends periodic or none");
          });
  v.rule("relaxation_time", l.relaxation_time == 0.0 || l.relaxation_time > 0.5,
         "is not over 0.5: the viscosity would not be positive",
         "give 0.51 to 1.5, or leave it out and give speed");
  v.rule("speed", l.relaxation_time > 0.0 || l.speed > 0.0, "is needed without relaxation_time",
         "give the largest speed of fluid or grains that is expected");
}

}  // namespace grouser
