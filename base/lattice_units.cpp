// SPDX-License-Identifier: BSD-3-Clause
#include "base/lattice_units.hpp"

#include <algorithm>
#include <cmath>

#include "base/time_step.hpp"
#include "base/units.hpp"

namespace grouser {
namespace {

// Beyond this no machine holds the lattice.
constexpr double kMostCells = 1e11;
// Below this relaxation time no collision here is stable at the speeds that a case has.
constexpr double kLeastRelaxationTime = 0.501;
constexpr double kGoodRelaxationTime = 0.51;
constexpr double kMostRelaxationTime = 5.0;
constexpr double kGoodMostRelaxationTime = 1.5;
constexpr double kMostGridReynolds = 50.0;
constexpr double kGoodGridReynolds = 10.0;

double height_of(const Case& input) {
  const double height = input.fluid.lattice.height;
  return height > 0.0 ? height : input.box.depth;
}

// What the fluid is told to do and grains do at the start.
double known_speed(const Case& input) {
  double speed = std::hypot(input.fluid.velocity_x, input.fluid.velocity_y, input.fluid.velocity_z);
  speed += std::abs(input.fluid.shear_rate) * height_of(input);
  for (const LatticeFaceCase& face : input.fluid.lattice.faces)
    speed = std::max(speed, std::hypot(face.velocity_x, face.velocity_y, face.velocity_z));
  for (const PlacedGrain& g : input.placed.grains)
    speed = std::max(speed, std::hypot(g.velocity_x, g.velocity_y, g.velocity_z));
  return speed;
}

double smallest_diameter(const Case& input) {
  return input.grains.size_curve.empty()
             ? 0.0
             : input.grains.size_curve.front().diameter * input.grains.coarse_graining;
}

double lattice_step(const Case& input, double speed) {
  const LatticeCase& lattice = input.fluid.lattice;
  const double viscosity = input.fluid.viscosity / input.fluid.density;
  if (lattice.relaxation_time > 0.0)
    return (lattice.relaxation_time - 0.5) / 3.0 * lattice.cell * lattice.cell / viscosity;
  return lattice.mach / std::sqrt(3.0) * lattice.cell / speed;
}

std::string scaled(const LatticeScale& s) {
  return "relaxation time " + rounded(s.relaxation_time) + ", Mach number " + rounded(s.mach) +
         ", grid Reynolds number " + rounded(s.grid_reynolds);
}

bool is_whole(double length, double cell) {
  const double cells = length / cell;
  return cells >= 0.5 && std::abs(cells - std::round(cells)) <= 1e-6 * cells;
}

}  // namespace

bool has_lattice(const Case& input) { return input.has_fluid && input.fluid.mode == "resolved"; }

LatticeScale lattice_scale(const Case& input, double longest) {
  const LatticeCase& lattice = input.fluid.lattice;
  const double speed = std::max(lattice.speed, known_speed(input));
  LatticeScale scale;
  scale.units.cell = lattice.cell;
  scale.units.density = input.fluid.density;
  scale.units.step = lattice_step(input, speed);
  const double lengths[3] = {input.box.length, input.box.width, height_of(input)};
  for (std::size_t a = 0; a < 3; ++a)
    if (const double cells = lengths[a] / lattice.cell; cells < kMostCells)
      scale.cells[a] = std::llround(cells);
  // A hair less than a whole number is that number.
  if (const double steps = scale.units.step / longest; steps < 1e9)
    scale.substeps = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(steps - 1e-9)));
  scale.viscosity_lu = scale.units.viscosity_lu(input.fluid.viscosity / input.fluid.density);
  scale.relaxation_time = 3.0 * scale.viscosity_lu + 0.5;
  scale.mach = std::sqrt(3.0) * scale.units.velocity_lu(speed);
  scale.grid_reynolds = scale.units.velocity_lu(speed) / scale.viscosity_lu;
  scale.smallest_grain = smallest_diameter(input) / lattice.cell;
  return scale;
}

std::string lattice_text(const Case& input) {
  const double grains_step = time_step_of(input);
  const LatticeScale s = lattice_scale(input, grains_step);
  std::string text = "lattice of " + std::to_string(s.cells[0]) + " x " +
                     std::to_string(s.cells[1]) + " x " + std::to_string(s.cells[2]) +
                     " cells of " + rounded(s.units.cell) + " m, step " + rounded(s.units.step) +
                     " s (" + std::to_string(s.substeps) + " of the grains), " + scaled(s) +
                     "; speeds are off by some " + rounded(100.0 * s.mach * s.mach) +
                     " % for compressibility";
  if (s.smallest_grain > 0.0) {
    // What calibration leaves at 7 cells, falling with the square of the cell.
    const double off = 3.0 * (7.4 / s.smallest_grain) * (7.4 / s.smallest_grain);
    text += "; the smallest grain is " + rounded(s.smallest_grain) +
            " cells wide, its drag off by some " + rounded(off) + " % in creeping flow";
  }
  return text;
}

void describe_lattice(FieldVisitor& v, const Case& input) {
  const bool wants = has_lattice(input);
  v.rule("fluid.mode", !wants || input.fluid.has_lattice, "resolved needs a lattice",
         "give fluid.lattice with cell and speed");
  v.rule("fluid.lattice", wants || !input.fluid.has_lattice, "goes with mode resolved alone",
         "give mode: resolved, or leave the lattice out");
  if (!wants || !input.fluid.has_lattice || !(input.fluid.lattice.cell > 0.0)) return;
  const LatticeCase& lattice = input.fluid.lattice;
  if (lattice.relaxation_time <= 0.5 && lattice.speed <= 0.0) return;
  const auto divides = [&](const char* what, double length) {
    const double cells = std::max(1.0, std::round(length / lattice.cell));
    v.rule(
        "fluid.lattice.cell", is_whole(length, lattice.cell),
        "does not divide " + std::string(what) + ": " + rounded(length / lattice.cell) + " cells",
        "give " + rounded(length / cells) + " m, or another " + what);
  };
  divides("box.length", input.box.length);
  divides("box.width", input.box.width);
  divides("the fluid's height", height_of(input));
  const LatticeScale s = lattice_scale(input, time_step_of(input));
  const double cells = input.box.length / lattice.cell * (input.box.width / lattice.cell) *
                       (height_of(input) / lattice.cell);
  v.rule("fluid.lattice.cell", cells < kMostCells, "comes to " + rounded(cells) + " cells",
         "over 1e11 no machine holds them; look at the units of cell and box");
  v.rule(
      "fluid.lattice", s.relaxation_time >= kLeastRelaxationTime,
      "comes to a relaxation time of " + rounded(s.relaxation_time) + ", too near 0.5 to be stable",
      "give smaller cells, a higher mach or a lower speed");
  v.rule("fluid.lattice", s.relaxation_time <= kMostRelaxationTime,
         "comes to a relaxation time of " + rounded(s.relaxation_time) + ", too large to be right",
         "give larger cells or a lower mach");
  v.rule("fluid.lattice", s.mach <= kMostMach,
         "comes to a Mach number of " + rounded(s.mach) + ", over " + rounded(kMostMach),
         "give a smaller relaxation_time, smaller cells, or mach in its place");
  v.rule("fluid.lattice", s.grid_reynolds <= kMostGridReynolds,
         "comes to a grid Reynolds number of " + rounded(s.grid_reynolds) + ", over " +
             rounded(kMostGridReynolds),
         "give smaller cells");
  const double heavy = input.grains.density / input.fluid.density;
  v.rule("grains.density", heavy >= kLightestGrain,
         "is " + rounded(heavy) +
             " of the fluid's: so light grains are thrown about by the fluid that they push aside",
         "mode resolved needs " + rounded(kLightestGrain) + " of the fluid's density or more");
  v.rule(
      "fluid.lattice.cell",
      s.smallest_grain == 0.0 || s.smallest_grain >= kLeastCellsPerGrain * (1.0 - 1e-9),
      "leaves the smallest grain " + rounded(s.smallest_grain) + " cells, too few to be resolved",
      "give " + rounded(smallest_diameter(input) / kLeastCellsPerGrain) +
          " m or less, or mode: submerged");
}

std::vector<Problem> lattice_warnings(const YamlNode& node, const Case& input) {
  std::vector<Problem> warnings;
  if (!has_lattice(input)) return warnings;
  const YamlNode* at = node.find_path("fluid.lattice");
  if (at == nullptr) at = &node;
  const LatticeScale s = lattice_scale(input, time_step_of(input));
  const auto warn = [&](bool is_good, const std::string& what, const std::string& hint) {
    if (!is_good) warnings.push_back({at->file, at->line, at->column, "fluid.lattice", what, hint});
  };
  warn(s.relaxation_time >= kGoodRelaxationTime,
       "comes to a relaxation time of " + rounded(s.relaxation_time) + ", which few flows survive",
       "0.51 and more is usual; smaller cells or a higher mach raise it");
  warn(s.relaxation_time <= kGoodMostRelaxationTime,
       "comes to a relaxation time of " + rounded(s.relaxation_time) + ", which is inaccurate",
       "1.5 and less is usual; a lower mach lowers it");
  warn(s.grid_reynolds <= kGoodGridReynolds,
       "comes to a grid Reynolds number of " + rounded(s.grid_reynolds) +
           ", which few flows survive",
       "10 and less is usual; smaller cells lower it");
  warn(s.smallest_grain == 0.0 || s.smallest_grain >= kGoodCellsPerGrain,
       "leaves the smallest grain " + rounded(s.smallest_grain) + " cells", "8 and more is usual");
  return warnings;
}

}  // namespace grouser
