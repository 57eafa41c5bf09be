// SPDX-License-Identifier: BSD-3-Clause
#include "base/case.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/hash.hpp"
#include "base/lattice_units.hpp"
#include "base/size_curve.hpp"
#include "base/stiffness_scale.hpp"
#include "base/substitution.hpp"
#include "base/time_step.hpp"
#include "base/units.hpp"

namespace grouser {
namespace {

// Every rank draws them all before the first step.
constexpr double kMostGrains = 1e10;

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

void describe_elasticity(FieldVisitor& v, SolidCase& s) {
  v.quantity(
      {"young_modulus", "Young's modulus; softer than real sand is usual, see docs", kOptional},
      s.young_modulus, "Pa", Range::positive());
  v.quantity({"poisson_ratio", "Poisson's ratio", kOptional}, s.poisson_ratio, "1",
             Range::open(-1.0, 0.5));
}

void describe_solid(FieldVisitor& v, SolidCase& s) {
  v.group({"solid", "elastic constants of the solid", kOptional},
          [&](FieldVisitor& inner) { describe_elasticity(inner, s); });
}

void describe_surface(FieldVisitor& v, SurfaceCase& s) {
  v.quantity({"restitution", "normal restitution coefficient"}, s.restitution, "1",
             Range::closed(0.01, 1.0));
  v.quantity({"friction", "Coulomb friction coefficient"}, s.friction, "1", Range::closed(0.0, 10));
  v.quantity({"rolling_friction", "rolling resistance coefficient", kOptional}, s.rolling_friction,
             "1", Range::closed(0.0, 10));
}

void describe_box(FieldVisitor& v, BoxCase& b) {
  v.quantity({"length", "inner length along the driving direction x"}, b.length, "m",
             Range::positive());
  v.quantity({"width", "inner width along y"}, b.width, "m", Range::positive());
  v.quantity({"depth", "height of the walls"}, b.depth, "m", Range::positive());
  describe_solid(v, b.solid);
}

void describe_size_point(FieldVisitor& v, SizePoint& p) {
  v.quantity({"diameter", "grain diameter of the real soil"}, p.diameter, "m", Range::positive());
  v.quantity({"finer", "fraction of grains finer than the diameter"}, p.finer, "1",
             Range::closed(0.0, 1.0));
}

bool is_size_curve(const std::vector<SizePoint>& curve) {
  if (curve.size() < 2) return false;
  if (curve.front().finer != 0.0 || curve.back().finer != 1.0) return false;
  for (std::size_t i = 1; i < curve.size(); ++i)
    if (curve[i].diameter <= curve[i - 1].diameter || curve[i].finer < curve[i - 1].finer)
      return false;
  return true;
}

// What placed grains would have as a size curve: neighbour lists and time steps go by it.
void take_sizes(const PlacedCase& placed, GrainsCase& g) {
  if (placed.grains.empty()) return;
  const double smallest = placed.smallest();
  g.size_curve = {{smallest, 0.0}, {std::max(placed.largest(), smallest * 1.000001), 1.0}};
}

void describe_placed_grains(FieldVisitor& v, GrainsCase& g) {
  v.quantity({"density", "density of the solid grain"}, g.density, "kg m-3", Range::positive());
  describe_solid(v, g.solid);
}

void describe_grains(FieldVisitor& v, GrainsCase& g) {
  v.quantity({"density", "density of the solid grain"}, g.density, "kg m-3", Range::positive());
  describe_solid(v, g.solid);
  v.list(
      {"size_curve", "cumulative grain size curve, fine to coarse"}, g.size_curve.size(),
      [&](std::size_t count) { g.size_curve.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_size_point(inner, g.size_curve[i]); });
  v.word({"size_basis", "what the size curve counts", kOptional}, g.size_basis, {"number", "mass"});
  v.quantity({"coarse_graining", "factor on every grain diameter", kOptional}, g.coarse_graining,
             "1", Range::closed(0.01, 1e4));
  v.integer({"seed", "seed of the random filling", kOptional}, g.seed, 0, kNoLimit);
  v.rule("size_curve", is_size_curve(g.size_curve),
         "must have two points or more, rising diameters and fractions from 0 to 1",
         "for example [{diameter: 1 mm, finer: 0}, {diameter: 2 mm, finer: 1}]");
}

void describe_contact(FieldVisitor& v, ContactCase& c) {
  v.word({"law", "normal and tangential contact law", kOptional}, c.law, {"hertz_mindlin"});
  v.word({"rolling", "rolling resistance law", kOptional}, c.rolling, {"none", "elastic_plastic"});
  v.quantity({"stiffness_scale",
              "factor on every Young's modulus in contacts, for longer steps; see docs", kOptional},
             c.stiffness_scale, "1", Range::above_up_to(0.0, 1.0));
  v.group({"grain_grain", "surface of grains against each other"},
          [&](FieldVisitor& inner) { describe_surface(inner, c.grain_grain); });
  v.group({"grain_box", "surface of grains against the box"},
          [&](FieldVisitor& inner) { describe_surface(inner, c.grain_box); });
  v.group({"grain_wheel", "surface of grains against the wheel", kOptional},
          [&](FieldVisitor& inner) { describe_surface(inner, c.grain_wheel); });
}

void describe_bed(FieldVisitor& v, BedCase& b) {
  v.quantity({"depth", "settled depth wanted"}, b.depth, "m", Range::positive());
  v.quantity(
      {"solid_fraction", "solid fraction expected after settling; sets the grain count", kOptional},
      b.solid_fraction, "1", Range::closed(0.05, 0.9));
  v.quantity(
      {"preparation_friction",
       "grain-grain friction while settling, rolling friction in proportion; low gives dense",
       kOptional},
      b.preparation_friction, "1", Range::closed(0.0, 10));
  v.quantity({"settled_energy_ratio",
              "settled when mean kinetic energy per grain over mean m g d "
              "is below this",
              kOptional},
             b.settled_energy_ratio, "1", Range::positive());
  v.quantity({"settle_limit", "settling longer than this simulated time has failed", kOptional},
             b.settle_limit, "s", Range::positive());
}

void describe_wheel_shape(FieldVisitor& v, WheelCase& w) {
  v.word({"profile", "shape of the wheel", kOptional}, w.profile, {"drum", "grousers", "stl"});
  v.quantity({"diameter", "outer diameter, grousers included"}, w.diameter, "m", Range::positive());
  v.quantity({"width", "width of the wheel"}, w.width, "m", Range::positive());
  v.integer({"facets", "flat facets around the rim", kOptional}, w.facets, 6, 100000);
  v.integer({"grousers", "number of grousers", kOptional}, w.grousers, 0, 1000);
  v.quantity({"grouser_height", "grouser height", kOptional}, w.grouser_height, "m",
             Range::not_negative());
  v.quantity({"grouser_width", "grouser thickness along the rim", kOptional}, w.grouser_width, "m",
             Range::not_negative());
  v.word({"stl_file", "surface file; its y axis through the origin is the axle", kOptional},
         w.stl_file, {});
  v.quantity({"stl_scale", "length of one unit of the surface file", kOptional}, w.stl_scale, "m",
             Range::positive());
  describe_solid(v, w.solid);
  v.check("stl_file", names_in_braces(w.stl_file).empty(), "takes no {name}",
          "write the path itself; it counts from the YAML file");
  v.rule("stl_file", w.profile != "stl" || !w.stl_file.empty(), "is needed for profile stl",
         "name the surface file");
  v.rule("grousers",
         w.profile != "grousers" || (w.grousers > 0 && w.grouser_height > 0 &&
                                     w.grouser_width > 0 && w.grouser_height < 0.5 * w.diameter &&
                                     static_cast<double>(w.grousers) * w.grouser_width <
                                         3.14159 * (w.diameter - 2 * w.grouser_height)),
         "grousers, grouser_height and grouser_width do not make a wheel",
         "all must be positive and the grousers must fit around the rim");
}

void describe_wheel_motion(FieldVisitor& v, WheelCase& w) {
  v.quantity({"load", "vertical load on the axle, weight of the wheel included"}, w.load, "N",
             Range::positive());
  v.quantity(
      {"inertia", "moment of inertia about the axle; 0 = solid cylinder of that weight", kOptional},
      w.inertia, "kg m2", Range::not_negative());
  v.quantity({"start", "axle position at the start over box length", kOptional}, w.start, "1",
             Range::open(0.0, 1.0));
  v.quantity({"settle_time", "free vertical settling before driving off", kOptional}, w.settle_time,
             "s", Range::not_negative());
  v.quantity(
      {"settle_speed",
       "sinking speed at which a damper carries the load while settling; 0 = no damper", kOptional},
      w.settle_speed, "m s-1", Range::not_negative());
  v.quantity({"ramp_time", "linear rise of speed and spin", kOptional}, w.ramp_time, "s",
             Range::not_negative());
  v.quantity({"forward_speed", "speed of the axle"}, w.forward_speed, "m s-1", Range::positive());
  v.quantity({"travel", "distance driven, ramp included"}, w.travel, "m", Range::positive());
  v.quantity({"average_travel", "last part of the travel, over which means are taken"},
             w.average_travel, "m", Range::positive());
  v.word({"drive", "what is prescribed about the axle", kOptional}, w.drive,
         {"slip", "towed", "torque", "rim_speed"});
  v.quantity({"slip", "slip i = 1 - v/(omega r), for drive slip", kOptional}, w.slip, "1",
             Range{-100.0, 0.99});
  v.quantity({"torque", "axle torque, positive drives forward, for drive torque", kOptional},
             w.torque, "N m", Range::any());
  v.quantity({"rim_speed", "omega r, for drive rim_speed; 0 = locked", kOptional}, w.rim_speed,
             "m s-1", Range::any());
  v.rule("average_travel", w.average_travel <= w.travel, "is longer than the travel",
         "make it the steady last part of the travel");
}

void describe_numerics(FieldVisitor& v, NumericsCase& n) {
  v.quantity({"rayleigh_fraction", "time step over the smallest Rayleigh time", kOptional},
             n.rayleigh_fraction, "1", Range::above_up_to(0.0, 0.5));
  v.quantity(
      {"time_step", "time step; 0 = from rayleigh_fraction or the shortest collision", kOptional},
      n.time_step, "s", Range::not_negative());
  v.quantity(
      {"max_overlap", "overlap over the smaller radius at which the run is broken", kOptional},
      n.max_overlap, "1", Range::above_up_to(0.0, 1.0));
}

void describe_activity(FieldVisitor& v, ActivityCase& a) {
  v.word(
      {"mode", "all: every grain is computed; sleep: those at rest sleep in wheel runs", kOptional},
      a.mode, {"all", "sleep"});
  v.quantity(
      {"speed", "speed below which a grain may fall asleep, over sqrt(g d), d the mean diameter",
       kOptional},
      a.speed, "1", Range::above_up_to(0.0, 0.1));
  v.quantity(
      {"imbalance",
       "unbalanced force that wakes a grain, over its weight; over half of it none falls asleep",
       kOptional},
      a.imbalance, "1", Range::above_up_to(0.0, 1.0));
  v.integer({"interval", "time steps between looks at who falls asleep", kOptional}, a.interval, 1,
            1000000);
}

void describe_output(FieldVisitor& v, OutputCase& o) {
  v.quantity({"series_interval", "simulated time between rows of the time series", kOptional},
             o.series_interval, "s", Range::positive());
  v.quantity({"checkpoint_interval", "simulated time between checkpoints", kOptional},
             o.checkpoint_interval, "s", Range::positive());
  v.quantity({"snapshot_interval",
              "simulated time between VTKHDF snapshots of grains and wheel; 0 = none", kOptional},
             o.snapshot_interval, "s", Range::not_negative());
  v.optional_group(
      {"track", "one grain whose motion and forces are written to track.csv", kOptional},
      o.has_track, [&](FieldVisitor& inner) { describe(inner, o.track); });
}

double largest_diameter(const GrainsCase& grains) {
  return grains.size_curve.empty() ? 0.0
                                   : grains.size_curve.back().diameter * grains.coarse_graining;
}

// Whether two placed grains overlap.
bool any_overlap(const std::vector<PlacedGrain>& placed) {
  std::vector<PlacedGrain> grains = placed;
  std::sort(grains.begin(), grains.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  double largest = 0.0;
  for (const PlacedGrain& g : grains) largest = std::max(largest, g.diameter);
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (std::size_t k = i + 1; k < grains.size() && grains[k].x - grains[i].x < largest; ++k)
      if (std::hypot(grains[k].x - grains[i].x, grains[k].y - grains[i].y,
                     grains[k].z - grains[i].z) <
          0.5 * (grains[i].diameter + grains[k].diameter) * (1.0 - 1e-9))
        return true;
  return false;
}

bool is_in_box(const PlacedGrain& g, const BoxCase& box) {
  const double r = 0.5 * g.diameter * (1.0 - 1e-9);
  return g.x >= r && g.x <= box.length - r && g.y >= r && g.y <= box.width - r && g.z >= r &&
         g.z <= box.depth;
}

void check_placed(FieldVisitor& v, const Case& c) {
  if (!c.has_placed) return;
  const auto& grains = c.placed.grains;
  v.rule("placed", !c.has_wheel, "does not go with a wheel",
         "a wheel drives over a bed; leave one of the two out");
  for (std::size_t i = 0; i < grains.size(); ++i)
    v.rule("placed.grains", is_in_box(grains[i], c.box),
           "grain " + std::to_string(i) + " is not inside the box",
           "keep its surface off the walls and its centre below box.depth");
  v.rule("placed.grains", !any_overlap(grains), "has grains that overlap", "move them apart");
  const auto count = static_cast<std::int64_t>(grains.size());
  for (const ProbeCase& probe : c.probes)
    v.rule("probes", probe.grain < count, "name a grain that is not there",
           "grains are numbered from 0 to " + std::to_string(count - 1));
  v.rule("output.track", !c.output.has_track || c.output.track.grain < count,
         "names a grain that is not there",
         "grains are numbered from 0 to " + std::to_string(count - 1));
}

void check_fluid(FieldVisitor& v, const Case& c) {
  for (const ProbeCase& probe : c.probes)
    v.rule("probes", c.has_fluid || probe.along != "reynolds",
           "go along a Reynolds number, but there is no fluid", "give fluid:, or another variable");
  if (!c.has_fluid || has_lattice(c) || c.grains.size_curve.empty()) return;
  const double diameter = c.grains.size_curve.front().diameter * c.grains.coarse_graining;
  v.rule("fluid.wall",
         c.fluid.wall.law == "none" || largest_diameter(c.grains) < 0.5 * c.fluid.wall_diameter,
         "is too near for its law: the largest grain has over half of its diameter",
         "leave the wall out, or look at units");
  if (c.fluid.drag.amplitude == 0.0) return;
  const double time = drag_time(c.fluid, diameter, c.grains.density) / c.fluid.drag.amplitude;
  const double step = time_step_of(c);
  v.rule("fluid", step <= 0.5 * time,
         "drag changes the speed of the smallest grain within " + rounded(time) +
             " s, too fast for the time step of " + rounded(step) + " s",
         "give numerics.time_step: " + rounded(0.2 * time) + " s or less; look at units");
}

}  // namespace

void describe(FieldVisitor& v, Case& c) {
  v.quantity({"gravity", "acceleration of gravity, downward", kOptional}, c.gravity, "m s-2",
             Range::positive());
  v.group({"box", "open-topped box that holds the soil"},
          [&](FieldVisitor& inner) { describe_box(inner, c.box); });
  v.optional_group({"placed", "grains placed one by one, without bed and size curve", kOptional},
                   c.has_placed, [&](FieldVisitor& inner) { describe(inner, c.placed); });
  v.group({"grains", "the soil's grains"}, [&](FieldVisitor& inner) {
    c.has_placed ? describe_placed_grains(inner, c.grains) : describe_grains(inner, c.grains);
  });
  if (c.has_placed) take_sizes(c.placed, c.grains);
  v.group({"contact", "contact laws and surfaces"},
          [&](FieldVisitor& inner) { describe_contact(inner, c.contact); });
  if (!c.has_placed)
    v.group({"bed", "preparation of the bed"},
            [&](FieldVisitor& inner) { describe_bed(inner, c.bed); });
  v.optional_group({"fluid", "the fluid around the grains; dry without", kOptional}, c.has_fluid,
                   [&](FieldVisitor& inner) { describe(inner, c.fluid); });
  v.list(
      {"probes", "forces on single grains over time or over their state", kOptional},
      c.probes.size(), [&](std::size_t count) { c.probes.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe(inner, c.probes[i]); });
  v.optional_group({"wheel", "the wheel; without it the run only settles a bed", kOptional},
                   c.has_wheel, [&](FieldVisitor& inner) {
                     describe_wheel_shape(inner, c.wheel);
                     describe_wheel_motion(inner, c.wheel);
                   });
  v.group({"numerics", "time step and limits", kOptional},
          [&](FieldVisitor& inner) { describe_numerics(inner, c.numerics); });
  v.group({"activity", "whether grains at rest are left out of the computation", kOptional},
          [&](FieldVisitor& inner) { describe_activity(inner, c.activity); });
  v.group({"output", "what is written how often", kOptional},
          [&](FieldVisitor& inner) { describe_output(inner, c.output); });
  describe_lattice(v, c);
  describe_time_step(v, c);
  check_placed(v, c);
  check_fluid(v, c);
  v.rule("activity.mode", c.activity.mode == "all" || (!c.has_fluid && c.probes.empty()),
         "sleep does not go with a fluid or with probes, which push grains that nothing touches",
         "leave it out");
  const double grains = grain_count(c);
  v.rule("grains.size_curve", grains <= kMostGrains,
         "comes to " + rounded(grains) + " grains in the bed",
         "over 1e10 no machine holds them; look at the units of diameters and box, or raise "
         "coarse_graining");
  v.rule("box", largest_diameter(c.grains) < std::min({c.box.length, c.box.width, c.box.depth}),
         "is smaller than one grain",
         "the largest grain, coarse graining included, is " +
             rounded(largest_diameter(c.grains) * 1e3) + " mm");
  v.rule("bed", c.bed.depth <= c.box.depth, "depth is above the box walls",
         "the walls are as high as box.depth");
  v.rule("bed", c.has_placed || c.bed.depth >= largest_diameter(c.grains),
         "depth is less than one grain",
         "the largest grain, coarse graining included, is " +
             rounded(largest_diameter(c.grains) * 1e3) + " mm");
  v.rule("wheel", !c.has_wheel || c.wheel.start * c.box.length >= 0.25 * c.wheel.diameter,
         "starts in the back wall", "start must leave a quarter of the diameter behind the axle");
  v.rule("wheel", !c.has_wheel || c.wheel.width < c.box.width, "is wider than the box", "");
  v.rule("wheel",
         !c.has_wheel || c.wheel.start * c.box.length + c.wheel.travel <=
                             c.box.length - 0.25 * c.wheel.diameter,
         "runs into the end wall",
         "start, travel and a quarter of the diameter must fit into the box length");
}

Case read_case(const YamlNode& node, std::vector<Problem>& problems) {
  Case input;
  read_fields(
      node, [&](FieldVisitor& visitor) { describe(visitor, input); }, problems);
  return input;
}

YamlNode write_case(const Case& input) {
  Case copy = input;
  return write_fields([&](FieldVisitor& visitor) { describe(visitor, copy); });
}

Case bed_case(const Case& input) {
  Case bed = input;
  // Probes of a run with a wheel count from its start, when the bed has long settled.
  if (input.has_wheel) bed.probes.clear();
  // The bed under a wheel settles in the submerged mode; the lattice begins at rest with the wheel.
  if (input.has_wheel && has_lattice(input)) {
    bed.fluid.mode = FluidCase{}.mode;
    bed.fluid.has_lattice = false;
    bed.fluid.lattice = LatticeCase{};
  }
  bed.has_wheel = false;
  bed.wheel = WheelCase{};
  bed.contact.grain_wheel = SurfaceCase{};
  bed.activity = ActivityCase{};
  return bed;
}

double run_duration(const Case& input) {
  if (input.has_placed) return input.placed.duration;
  if (!input.has_wheel) return 0.0;
  const WheelCase& wheel = input.wheel;
  const double ramp_travel = 0.5 * wheel.ramp_time * wheel.forward_speed;
  const double drive = wheel.travel >= ramp_travel
                           ? 0.5 * wheel.ramp_time + wheel.travel / wheel.forward_speed
                           : std::sqrt(2.0 * wheel.travel * wheel.ramp_time / wheel.forward_speed);
  return wheel.settle_time + drive;
}

std::vector<Problem> case_warnings(const YamlNode& node, const Case& input) {
  std::vector<Problem> warnings = time_step_warnings(node, input);
  for (const Problem& one : stiffness_warnings(node, input)) warnings.push_back(one);
  for (const Problem& one : lattice_warnings(node, input)) warnings.push_back(one);
  return warnings;
}

namespace {

// A value that the wheel's drive or profile never looks at makes no other run.
void leave_out_unused(WheelCase& wheel) {
  const WheelCase defaults;
  if (wheel.drive != "slip") wheel.slip = defaults.slip;
  if (wheel.drive != "torque") wheel.torque = defaults.torque;
  if (wheel.drive != "rim_speed") wheel.rim_speed = defaults.rim_speed;
  if (wheel.profile != "stl") {
    wheel.stl_file = defaults.stl_file;
    wheel.stl_scale = defaults.stl_scale;
  } else {
    wheel.facets = defaults.facets;
    // A campaign names the file by its content; where it lies makes no other run.
    wheel.stl_file = std::filesystem::path(wheel.stl_file).filename().string();
  }
  if (wheel.profile == "grousers") return;
  wheel.grousers = defaults.grousers;
  wheel.grouser_height = defaults.grouser_height;
  wheel.grouser_width = defaults.grouser_width;
}

}  // namespace

std::string content_key(const Case& input) {
  Case copy = input;
  copy.output = OutputCase{};
  copy.numerics.max_overlap = NumericsCase{}.max_overlap;
  leave_out_unused(copy.wheel);
  // A step that follows from the input alone is in the key by the input, unless the shortest
  // collision sets it, which is younger than the first keys. So are the scale of the stiffness
  // and the activity.
  if (is_step_of_collision(copy)) copy.numerics.time_step = longest_time_step(copy);
  YamlNode node = write_case(copy);
  if (copy.contact.stiffness_scale == 1.0)
    std::erase_if(node.find("contact")->entries,
                  [](const auto& entry) { return entry.first == "stiffness_scale"; });
  if (copy.activity.mode == "all")
    std::erase_if(node.entries, [](const auto& entry) { return entry.first == "activity"; });
  return hash_text(emit_yaml(node));
}

}  // namespace grouser
