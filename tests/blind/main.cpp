// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "tests/blind/cases.hpp"

// Writes concealed cases: FOLDER/case_###/{recording.yaml, baseline.yaml, *.csv} and
// FOLDER/sealed/truth.json, which the scorer alone may open.
//   blind-spheres FOLDER SEED NULLS SINGLES DOUBLES UNLISTED
namespace blind {
namespace {

namespace fs = std::filesystem;

std::string value(const std::string& name, double mean, const std::string& unit, double sd) {
  std::ostringstream out;
  out.precision(10);
  out << "{name: " << name << ", value: \"" << mean << " " << unit << "\", uncertainty: \"" << sd
      << " " << unit << "\"}\n";
  return out.str();
}

void write_series(const fs::path& file, const Case& c, const Run& run, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::ofstream csv(file);
  csv.precision(9);
  csv << "time [s],gap [mm]" << (c.has_speed ? ",speed [mm/s]" : "") << "\n";
  std::vector<double> noise(run.clean.size());
  for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = normal(random);
  for (int i = 0; i < run.samples; ++i) {
    csv << i * run.interval;
    for (std::size_t k = 0; k < run.clean.size(); ++k) {
      noise[k] = c.correlation * noise[k] +
                 std::sqrt(1.0 - c.correlation * c.correlation) * normal(random);
      csv << "," << 1e3 * (run.clean[k][std::size_t(i)] + run.noise[k] * noise[k]);
    }
    csv << "\n";
  }
}

void write_case(const fs::path& folder, const Case& c, std::mt19937_64& random) {
  fs::create_directories(folder);
  std::ofstream yaml(folder / "recording.yaml");
  yaml.precision(6);
  yaml
      << "recording: 2\nname: " << folder.filename().string()
      << "\ntitle: A sphere let go in a liquid\nsource: {citation: made for a blind test, licence: "
         "none, provenance: computed}\nexperiment:\n  case: sphere_in_fluid\ntime: {column: time, "
         "unit: s}\nchannels:\n  - {name: gap, unit: mm, column: gap, sign: upward from the floor, "
         "noise: "
      << 1e3 * c.stated * c.runs[0].noise[0] << " mm}\n";
  if (c.has_speed)
    yaml << "  - {name: settling_speed, unit: mm/s, column: speed, sign: downward, noise: "
         << 1e3 * c.stated * c.runs[0].noise[1] << " mm/s}\n";
  yaml << "conditions:\n";
  for (const Run& run : c.runs) {
    const World& t = run.told;
    yaml << "  - name: " << run.name << "\n    data: " << run.name
         << ".csv\n    split: " << (run.is_held_out ? "held_out" : "fit") << "\n    values:\n";
    yaml << "      - " << value("diameter", 1e3 * t.diameter, "mm", 3.0 * t.diameter) << "      - "
         << value("particle_density", t.sphere_density, "kg m-3", 0.003 * t.sphere_density)
         << "      - " << value("fluid_density", t.liquid_density, "kg m-3", 0.0) << "      - "
         << value("viscosity", t.viscosity, "Pa s", 0.015 * t.viscosity) << "      - "
         << value("restitution", t.restitution, "1", 0.0) << "      - "
         << value("container_width", 1e3 * t.width, "mm", 0.0) << "      - "
         << value("release_gap", 1e3 * t.drop, "mm", 10.0 * t.drop) << "      - "
         << value("trigger", t.start, "s", 5.0 * run.interval);
    write_series(folder / (run.name + ".csv"), c, run, random);
  }
  std::ofstream base(folder / "baseline.yaml");
  base << "baseline: 1\nmodel: sphere_ode\nterms:\n  - {name: drag_inertia, amplitude: "
       << c.knows_inertia << "}\n  - {name: added_mass, amplitude: " << c.knows_virtual_mass
       << "}\n";
}

std::string truth_of(const std::string& name, const Case& c, std::size_t number) {
  std::ostringstream out;
  out << "{\"case\": \"" << name << "\", \"kind\": \"" << c.kind << "\", \"secrets\": [";
  for (std::size_t i = 0; i < c.secrets.size(); ++i)
    out << (i > 0 ? ", " : "") << "\"" << c.secrets[i] << "\"";
  out << "], \"regime\": \"" << c.regime << "\", \"amplitude\": " << c.amplitude
      << ", \"visibility\": " << c.visibility << ", \"fitted_runs\": " << c.runs.size() - 1
      << ", \"channel\": " << c.sensor_channel << ", \"half\": \""
      << (number % 2 == 0 ? "development" : "test") << "\", \"masks\": {";
  for (std::size_t k = 0; k < c.runs.size(); ++k) {
    out << (k > 0 ? ", " : "") << "\"" << c.runs[k].name << "\": \"";
    for (const bool on : c.runs[k].mask) out << (on ? '1' : '0');
    out << "\"";
  }
  out << "}}";
  return out.str();
}

int run(int argc, char** argv) {
  if (argc != 7) {
    std::cerr << "blind-spheres FOLDER SEED NULLS SINGLES DOUBLES UNLISTED\n";
    return 2;
  }
  const fs::path folder = argv[1];
  const auto seed = std::strtoull(argv[2], nullptr, 10);
  fs::create_directories(folder / "sealed");
  std::ofstream truth(folder / "sealed" / "truth.json");
  truth << "{\"tier\": \"t0\", \"cases\": [\n";
  std::vector<std::pair<std::string, int>> kinds;
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < std::atoi(argv[3 + k]); ++i)
      kinds.emplace_back(
          std::vector<std::string>{"null", "single", "double", "unlisted"}[std::size_t(k)], i);
  // Numbers must not tell the kind.
  std::mt19937_64 order(seed);
  std::shuffle(kinds.begin(), kinds.end(), order);
  for (std::size_t n = 0; n < kinds.size(); ++n) {
    std::mt19937_64 random(seed * 1000003 + n);
    const auto& [kind, i] = kinds[n];
    const auto& listed = listed_secrets();
    const auto& unlisted = unlisted_secrets();
    std::vector<std::string> secrets;
    const auto at = static_cast<std::size_t>(i);
    if (kind == "single") secrets = {listed[at % listed.size()]};
    if (kind == "unlisted") secrets = {unlisted[at % unlisted.size()]};
    // A force and something else: never two sensors, never two of the same family.
    if (kind == "double") secrets = {listed[at % 5], listed[5 + at % 7]};
    const Case c = draw_case(kind, secrets, at % 4 == 3, random);
    std::string name = std::to_string(n + 1);
    name = "case_" + std::string(name.size() < 3 ? 3 - name.size() : 0, '0') + name;
    write_case(folder / name, c, random);
    // Halves by class and regime: every other of each.
    truth << (n > 0 ? ",\n" : "")
          << truth_of(name, c, at / std::max<std::size_t>(1, kind == "single" ? listed.size() : 1));
  }
  truth << "\n]}\n";
  std::cout << kinds.size() << " cases in " << folder.string() << "\n";
  return truth ? 0 : 1;
}

}  // namespace
}  // namespace blind

int main(int argc, char** argv) { return blind::run(argc, argv); }
