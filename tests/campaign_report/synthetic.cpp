// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic.hpp"

#include <cmath>
#include <map>
#include <random>

#include "base/run_contract.hpp"
#include "base/units.hpp"
#include "campaign/report/run_output.hpp"

namespace grouser::synthetic {
namespace {

constexpr double kSettleTime = 0.1;
constexpr double kRow = 1e-3;
constexpr double kSeedStep = 0.03;

/// Uniform in [-1, 1), the same on every machine.
class Noise {
 public:
  explicit Noise(unsigned seed) : engine_(seed) {}
  double operator()() { return 2.0 * static_cast<double>(engine_() >> 8) / 16777216.0 - 1.0; }

 private:
  std::mt19937 engine_;
};

double seed_offset(int seed, int seeds) { return kSeedStep * (seed - 0.5 * (seeds + 1)); }

/// One row of series.csv: cells by header name, the others empty.
std::string row_text(const std::map<std::string, double>& cells, const std::string& phase) {
  std::string text;
  const std::string header = kSeriesHeader;
  for (std::size_t from = 0; from <= header.size();) {
    const std::size_t to = std::min(header.find(',', from), header.size());
    const std::string name = header.substr(from, to - from);
    if (from > 0) text += ',';
    if (name == "phase")
      text += phase;
    else if (const auto cell = cells.find(name); cell != cells.end())
      text += format_number(cell->second);
    from = to + 1;
  }
  return text + "\n";
}

Recording recording() {
  Recording r;
  r.name = "jelinek2020_wheel_71cm";
  r.title = "71 cm rigid wheel in dense sand";
  r.citation = "B. Jelinek et al. (2020), Table 2";
  r.licence = "re-tabulated with citation";
  r.provenance = "Table 2, typed by hand.";
  r.wheel_diameter = 0.7127;
  r.wheel_width = 0.1778;
  r.load = 1922.0;
  r.forward_speed = 1.67;
  r.soil = "Dense dry sand, cone index 400 kPa.";
  r.channels = {{"pull_coefficient", "1", "forward"}, {"gross_coefficient", "1", "driven"}};
  r.caveats = {"Table 1 says 1922 N, the caption of Fig. 10 says 1992 N."};
  const auto add = [&](const char* condition, double slip, const char* kind, Observable observable,
                       double value) {
    r.points.push_back({condition, slip, kind, observable, value, kNaN, kNaN});
  };
  add("slip_20", 0.2, "lab", Observable::kPullCoefficient, 0.17);
  add("slip_20", 0.2, "lab", Observable::kGrossCoefficient, 0.31);
  add("towed", kNaN, "lab", Observable::kPullCoefficient, -0.12);
  add("slip_20", 0.2, "paper_dem", Observable::kPullCoefficient, 0.15);
  add("slip_20", 0.2, "paper_dem", Observable::kGrossCoefficient, 0.20);
  add("towed", kNaN, "paper_dem", Observable::kPullCoefficient, -0.08);
  return r;
}

std::vector<AttemptData> attempts(int seed) {
  std::vector<AttemptData> list;
  for (int chunk = 1; chunk <= 3; ++chunk) {
    AttemptData a;
    a.chunk = chunk;
    a.number = chunk;
    a.state = chunk == 3 ? "COMPLETED" : "CHUNK_DONE";
    a.outcome = chunk == 3 ? "finished" : "paused";
    a.wall_seconds = 12.5;
    a.compute_seconds = 12.0;
    a.checkpoint_seconds = 0.25;
    a.start_step = 1000 * (chunk - 1);
    a.steps_done = 1000;
    a.particles = 12700;
    a.ranks = 1;
    const auto hash = [&](int at) {
      return "00c0ffee0000" + std::to_string(1000 + 10 * seed + at);
    };
    a.state_hash = hash(chunk);
    if (chunk > 1) a.restart_hash = hash(chunk - 1);
    list.push_back(a);
  }
  return list;
}

}  // namespace

Truth truth_of(const std::string& point) {
  static const std::map<std::string, Truth> kTruth{
      {"braked_20", {-0.20, -0.30, -0.22, 0.021}}, {"towed", {-0.035, -0.10, 0.0, 0.014}},
      {"slip_00", {0.0, -0.07, 0.04, 0.013}},      {"slip_10", {0.10, 0.08, 0.17, 0.015}},
      {"slip_20", {0.20, 0.155, 0.24, 0.018}},     {"slip_40", {0.40, 0.19, 0.29, 0.026}}};
  return kTruth.at(point);
}

std::vector<std::string> point_labels() {
  return {"braked_20", "towed", "slip_00", "slip_10", "slip_20", "slip_40"};
}

Case case_of(const std::string& point, int seed) {
  Case c;
  c.box = {1.2192, 0.5334, 0.2223, {}};
  c.grains.size_curve = {{0.76e-3, 0.0}, {1.62e-3, 0.5}, {2.29e-3, 1.0}};
  c.grains.coarse_graining = 14.0;
  c.grains.seed = seed;
  c.contact.rolling = "elastic_plastic";
  c.bed.depth = 0.2006;
  c.has_wheel = true;
  c.wheel.diameter = 0.7127;
  c.wheel.width = 0.1778;
  c.wheel.load = 1922.0;
  c.wheel.forward_speed = 1.67;
  c.wheel.travel = 0.4;
  c.wheel.average_travel = 0.2;
  c.wheel.drive = point == "towed" ? "towed" : "slip";
  c.wheel.slip = point == "towed" ? 0.0 : truth_of(point).slip;
  return c;
}

std::string series_text(const std::string& point, const Case& input, int seed, double travel) {
  const Truth truth = truth_of(point);
  const double offset = seed_offset(seed, 2);
  const double load = input.wheel.load;
  const double rim = input.wheel.forward_speed / (1.0 - truth.slip);
  Noise noise(static_cast<unsigned>(17 * seed) + static_cast<unsigned>(point.size()));
  double drift = 0.0;
  std::string text = std::string(kSeriesHeader) + "\n";
  for (int i = 0;; ++i) {
    const double time = kRow * (i + 1);
    const bool is_driving = time > kSettleTime;
    const double at = std::max(0.0, time - kSettleTime) * input.wheel.forward_speed;
    if (at > travel) break;
    drift = 0.8 * drift + 0.03 * noise();
    const double grown = 1.0 - std::exp(-at / 0.02);
    const double pull = grown * (truth.pull + offset) + drift;
    const double gross = grown * (truth.gross + offset) + 0.7 * drift;
    std::map<std::string, double> cells{
        {"step [1]", 50.0 * (i + 1)},
        {"time [s]", time},
        {"travel [m]", at},
        {"sinkage [m]",
         truth.sinkage * (1.0 - 0.35 * std::exp(-at / 0.05)) * (1.0 - std::exp(-time / 0.01))},
        {"vertical_force [N]", load * (1.0 + drift)}};
    if (is_driving)
      cells.insert({{"slip [1]", truth.slip},
                    {"spin [rad s-1]", rim / (0.5 * input.wheel.diameter)},
                    {"forward_speed [m s-1]", input.wheel.forward_speed},
                    {"pull [N]", pull * load},
                    {"gross_tractive_effort [N]", gross * load},
                    {"motion_resistance [N]", (gross - pull) * load},
                    {"pull_coefficient [1]", pull},
                    {"gross_coefficient [1]", gross}});
    text += row_text(cells, is_driving ? "driving" : "wheel_settling");
  }
  return text;
}

std::string slice_text(const Case& input, int seed) {
  std::string text = "kind,x [m],z [m],radius [m],displacement [m]\n";
  const auto row = [&](const char* kind, double x, double z, const std::string& rest) {
    text += std::string(kind) + "," + format_number(x) + "," + format_number(z) + "," + rest + "\n";
  };
  const double radius = 0.5 * input.wheel.diameter;
  const double axle = 0.25 * input.box.length + input.wheel.travel;
  const double lowest = input.bed.depth - 0.02;
  Noise noise(static_cast<unsigned>(seed));
  for (int i = 0; i < 2000; ++i) {
    const double r = 0.0113 * (1.0 + 0.2 * noise());
    const double x = r + (0.5 + 0.5 * noise()) * (input.box.length - 2.0 * r);
    const double z = r + (0.5 + 0.5 * noise()) * (input.bed.depth - 2.0 * r);
    if (std::hypot(x - axle, z - lowest - radius) < radius) continue;
    const double behind = x < axle ? 0.25 : 0.08;
    const double depth = input.bed.depth - z;
    const double displacement =
        0.08 * std::exp(-depth / 0.05) * std::exp(-std::pow((x - axle) / behind, 2));
    row("grain", x, z, format_number(r) + "," + format_number(displacement));
  }
  for (int i = 0; i < 180; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * i / 180.0;
    row("wheel", axle + radius * std::cos(angle), lowest + radius + radius * std::sin(angle), ",");
  }
  row("box", input.box.length, input.box.depth, ",");
  return text;
}

ReportData campaign(int seeds) {
  ReportData data;
  data.name = "wheel_71cm_slip_sweep";
  data.title = "71 cm wheel on dense sand, slip sweep";
  data.made_at = "2026-03-01 14:05 UTC";
  data.settings.neglected = {"Coarse graining. Grains are 14 times the size of the sand's.",
                             "Shape. Grains are spheres."};
  data.recordings = {recording()};
  for (const std::string& point : point_labels())
    for (int seed = 1; seed <= seeds; ++seed) {
      RunData run;
      run.label = point + "-s" + std::to_string(seed);
      run.key = "0123456789abcde" + std::to_string(seed);
      run.state = "COMPLETED";
      run.is_finished = true;
      run.axes = {{"slip", point}, {"seed", "s" + std::to_string(seed)}};
      run.has_case = true;
      run.input = case_of(point, seed);
      run.time = run.end_time = 0.34;
      run.particles = 12700;
      run.state_hash = "feed0000beef0000";
      run.series = parse_series(series_text(point, run.input, seed, 0.4), run.label);
      run.slice = parse_slice(slice_text(run.input, seed), run.label, 4000);
      run.attempts = attempts(seed);
      data.runs.push_back(run);
    }
  data.provenance = {{"Report made by", "grouser, test"}, {"Created", "2026-03-01 13:00 UTC"}};
  return data;
}

}  // namespace grouser::synthetic
