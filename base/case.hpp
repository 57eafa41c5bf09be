// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/fluid_case.hpp"
#include "base/grain_case.hpp"
#include "base/schema.hpp"

namespace grouser {

/// The whole input of one engine run as plain values in SI units. The campaign manager checks and
/// freezes it, the engine reads the frozen file; both use the one description below, so that what
/// `grouser validate` accepts is what the engine accepts.
///
/// Axes: x forward (box length), y across (box width), z up; the floor is z = 0.

/// Elastic constants of a solid.
struct SolidCase {
  double young_modulus = 50e6;  ///< [Pa]
  double poisson_ratio = 0.25;  ///< [1]
};

/// Surface properties of a pair of solids in contact.
struct SurfaceCase {
  double restitution = 0.5;       ///< normal restitution coefficient [1]
  double friction = 0.5;          ///< Coulomb friction coefficient [1]
  double rolling_friction = 0.0;  ///< rolling resistance coefficient [1]
};

/// Open-topped rectangular container.
struct BoxCase {
  double length = 0.0;  ///< along x [m]
  double width = 0.0;   ///< along y [m]
  double depth = 0.0;   ///< wall height along z [m]
  SolidCase solid;
};

/// One point of the cumulative grain size curve.
struct SizePoint {
  double diameter = 0.0;  ///< of the real soil, before coarse graining [m]
  double finer = 0.0;     ///< fraction finer than `diameter` [1]
};

struct GrainsCase {
  double density = 2650.0;  ///< of the solid [kg m-3]
  SolidCase solid;
  std::vector<SizePoint> size_curve;  ///< piecewise linear between points, fractions 0 to 1
  std::string size_basis = "number";  ///< what `finer` counts: "number" or "mass" of grains
  double coarse_graining = 1.0;       ///< factor on every diameter [1]
  std::int64_t seed = 1;              ///< of the random filling
};

struct ContactCase {
  std::string law = "hertz_mindlin";
  std::string rolling = "none";
  double stiffness_scale = 1.0;  ///< factor on every Young's modulus in contacts [1]
  SurfaceCase grain_grain;
  SurfaceCase grain_box;
  SurfaceCase grain_wheel;
};

/// How the bed is prepared: random loose filling, then settling under gravity.
struct BedCase {
  double depth = 0.0;                  ///< wanted settled depth [m]
  double solid_fraction = 0.6;         ///< expected after settling; sets the number of grains [1]
  double preparation_friction = 0.5;   ///< grain-grain friction while settling; rolling
                                       ///< friction is changed in proportion [1]
  double settled_energy_ratio = 1e-5;  ///< mean kinetic energy per grain over mean m g d [1]
  double settle_limit = 5.0;           ///< simulated time after which settling has failed [s]
};

/// Rigid wheel driven through the bed.
struct WheelCase {
  std::string profile = "drum";  ///< "drum" (smooth), "grousers", or "stl"
  double diameter = 0.0;         ///< over the grouser tips if there are any [m]
  double width = 0.0;            ///< [m]
  std::int64_t facets = 180;     ///< flat facets around the drum
  std::int64_t grousers = 0;     ///< number of grousers
  double grouser_height = 0.0;   ///< [m]
  double grouser_width = 0.0;    ///< thickness along the rim [m]
  std::string stl_file;          ///< for "stl"; axle is the file's y axis through its origin
  double stl_scale = 1.0;        ///< metres per unit of the file [m]
  SolidCase solid;
  double load = 0.0;            ///< vertical load on the axle, the wheel's weight included [N]
  double inertia = 0.0;         ///< about the axle; 0 = solid cylinder of weight `load` [kg m2]
  double start = 0.25;          ///< axle position at the start over box length [1]
  double settle_time = 0.1;     ///< free vertical settling before driving off [s]
  double settle_speed = 0.0;    ///< sinking speed at which a damper carries the whole load while
                                ///< settling; 0 = no damper [m s-1]
  double ramp_time = 0.01;      ///< linear rise of speed and spin after settling [s]
  double forward_speed = 0.0;   ///< [m s-1]
  double travel = 0.0;          ///< distance driven, the ramp included [m]
  double average_travel = 0.0;  ///< last part of the travel, over which means are taken [m]
  std::string drive = "slip";   ///< "slip", "towed", "torque" or "rim_speed"
  double slip = 0.0;            ///< i = 1 - v/(omega r), for "slip" [1]
  double torque = 0.0;          ///< on the axle, positive drives forward, for "torque" [N m]
  double rim_speed = 0.0;       ///< omega r, for "rim_speed" [m s-1]
};

struct NumericsCase {
  double rayleigh_fraction = 0.2;  ///< time step over the smallest Rayleigh time [1]
  double time_step = 0.0;          ///< 0 = automatic, see time_step_of [s]
  double max_overlap = 0.1;        ///< largest overlap over the smaller radius before the run is
                                   ///< judged broken [1]
};

/// Whether grains at rest sleep; docs/physics/activity.md.
struct ActivityCase {
  std::string mode = "all";  ///< "all" = every grain is computed, "sleep"
  double speed = 0.02;       ///< below it a grain is slow, over sqrt(g d) of the mean diameter [1]
  double imbalance = 0.5;    ///< unbalanced force that wakes, over the grain's weight [1]
  std::int64_t interval = 20;  ///< steps between looks at who falls asleep
};

struct OutputCase {
  double series_interval = 1e-3;      ///< simulated time between rows of the time series [s]
  double checkpoint_interval = 0.05;  ///< simulated time between checkpoints [s]
  double snapshot_interval = 0.0;     ///< simulated time between snapshots; 0 = none [s]
  bool has_track = false;             ///< one grain is written to track.csv
  TrackCase track;
};

struct Case {
  double gravity = 9.81;  ///< downward [m s-2]
  BoxCase box;
  GrainsCase grains;
  ContactCase contact;
  BedCase bed;
  bool has_placed = false;  ///< grains are placed one by one; neither bed nor size curve is given
  PlacedCase placed;
  bool has_wheel = false;  ///< without a wheel the run ends when the bed has settled
  WheelCase wheel;
  bool has_fluid = false;  ///< dry without
  FluidCase fluid;
  std::vector<ProbeCase> probes;  ///< forces on single grains
  NumericsCase numerics;
  ActivityCase activity;
  OutputCase output;
};

/// The one description of the input; see FieldVisitor.
void describe(FieldVisitor& visitor, Case& input);

/// Reads and checks a case; every problem is appended. Local.
Case read_case(const YamlNode& node, std::vector<Problem>& problems);

/// The case in SI units, reading back to the same bits. Local.
YamlNode write_case(const Case& input);

/// The part of the case that decides the settled bed: no wheel, and output left out.
Case bed_case(const Case& input);

/// Simulated time of a run with a wheel: settling, then the travel with its linear rise of speed
/// [s]; of placed grains, their duration. 0 for a bed, whose length is known only when it has
/// settled. Local.
double run_duration(const Case& input);

/// What is allowed but seldom meant, at its place in `node`, from which `input` was read without
/// problems. Local.
std::vector<Problem> case_warnings(const YamlNode& node, const Case& input);

/// Content key of a case: 16 hexadecimal digits of the XXH3 hash of its SI text, with what does not
/// change the trajectory (output intervals, the overlap limit, values of another drive or profile)
/// left out. Local.
std::string content_key(const Case& input);

}  // namespace grouser
