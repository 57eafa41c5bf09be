// SPDX-License-Identifier: BSD-3-Clause
#include "base/grain_case.hpp"

#include <algorithm>
#include <limits>

namespace grouser {
namespace {

void describe_grain(FieldVisitor& v, PlacedGrain& g) {
  v.quantity({"diameter", "grain diameter"}, g.diameter, "m", Range::positive());
  v.quantity({"x", "centre, along the box length"}, g.x, "m", Range::not_negative());
  v.quantity({"y", "centre, along the box width"}, g.y, "m", Range::not_negative());
  v.quantity({"z", "centre, above the floor"}, g.z, "m", Range::not_negative());
  v.quantity({"velocity_x", "at the start", kOptional}, g.velocity_x, "m s-1", Range::any());
  v.quantity({"velocity_y", "at the start", kOptional}, g.velocity_y, "m s-1", Range::any());
  v.quantity({"velocity_z", "at the start, upward", kOptional}, g.velocity_z, "m s-1",
             Range::any());
  v.quantity({"spin_x", "at the start", kOptional}, g.spin_x, "rad s-1", Range::any());
  v.quantity({"spin_y", "at the start, rolling forward positive", kOptional}, g.spin_y, "rad s-1",
             Range::any());
  v.quantity({"spin_z", "at the start", kOptional}, g.spin_z, "rad s-1", Range::any());
}

}  // namespace

double PlacedCase::smallest() const {
  double diameter = std::numeric_limits<double>::infinity();
  for (const PlacedGrain& grain : grains) diameter = std::min(diameter, grain.diameter);
  return diameter;
}

double PlacedCase::largest() const {
  double diameter = 0.0;
  for (const PlacedGrain& grain : grains) diameter = std::max(diameter, grain.diameter);
  return diameter;
}

double ProbeCase::at(double value) const {
  if (value < from || value > to) return 0.0;
  if (value < peak) return force * (value - from) / (peak - from);
  if (value > peak) return force * (to - value) / (to - peak);
  return force;
}

const char* unit_of_probe(const std::string& along) {
  if (along == "gap") return "m";
  if (along == "speed") return "m s-1";
  if (along == "reynolds") return "1";
  return "s";
}

void describe(FieldVisitor& v, PlacedCase& p) {
  v.quantity({"duration", "length of the run"}, p.duration, "s", Range::positive());
  v.list(
      {"grains", "the grains, numbered from 0"}, p.grains.size(),
      [&](std::size_t count) { p.grains.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_grain(inner, p.grains[i]); });
  v.rule("grains", !p.grains.empty(), "has no grain", "place one or more");
}

void describe(FieldVisitor& v, ProbeCase& p) {
  v.integer({"grain", "number of the grain it acts on"}, p.grain, 0,
            std::numeric_limits<std::int64_t>::max());
  v.word({"axis", "along which it acts", kOptional}, p.axis, {"x", "y", "z"});
  v.word({"along", "variable of the hat; sets the unit of from, peak and to", kOptional}, p.along,
         {"time", "gap", "speed", "reynolds"});
  const char* unit = unit_of_probe(p.along);
  v.quantity({"from", "where the force rises from 0"}, p.from, unit, Range::any());
  v.quantity({"peak", "where it is highest"}, p.peak, unit, Range::any());
  v.quantity({"to", "where it is back at 0"}, p.to, unit, Range::any());
  v.quantity({"force", "at the peak, positive along the axis"}, p.force, "N", Range::any());
  v.rule("peak", p.from <= p.peak && p.peak <= p.to && p.from < p.to, "is not between from and to",
         "from <= peak <= to, and from < to");
}

void describe(FieldVisitor& v, TrackCase& t) {
  v.integer({"grain", "number of the grain"}, t.grain, 0, std::numeric_limits<std::int64_t>::max());
  v.quantity({"interval", "simulated time between rows", kOptional}, t.interval, "s",
             Range::positive());
}

}  // namespace grouser
