// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bed_file.hpp"

#include <algorithm>
#include <fstream>
#include <numbers>
#include <sstream>

#include "base/errors.hpp"

namespace grouser::bench {
namespace {

std::ofstream open(const std::filesystem::path& file) {
  std::ofstream out(file);
  if (!out) throw StorageError("cannot write " + file.string());
  out.precision(17);
  return out;
}

// The numbers of a line; empty when something else stands in it.
std::vector<double> numbers_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<double> numbers;
  for (double number; in >> number;) numbers.push_back(number);
  if (!in.eof()) numbers.clear();
  return numbers;
}

// A row's motion, from its column 1 on.
void set_motion(Particle& p, const std::vector<double>& row) {
  p.position = {row[1], row[2], row[3]};
  p.velocity = {row[4], row[5], row[6]};
  p.spin = {row[7], row[8], row[9]};
}

}  // namespace

void write_bed(const std::filesystem::path& file, const std::vector<Particle>& grains) {
  std::ofstream out = open(file);
  for (const Particle& p : grains) {
    out << p.id;
    for (const Vec3& v : {p.position, p.velocity, p.spin})
      out << ' ' << v.x << ' ' << v.y << ' ' << v.z;
    out << ' ' << p.radius << '\n';
  }
  if (!out.flush()) throw StorageError("cannot write " + file.string());
}

std::vector<Particle> read_bed(const std::filesystem::path& file, double density) {
  std::vector<Particle> grains;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::vector<double> row = numbers_of(line);
    Particle p;
    p.id = static_cast<std::int64_t>(grains.size());
    if (row.size() != 11 || row[0] != static_cast<double>(p.id))
      throw FormatError(file.string() + " is not a bed in line " + std::to_string(p.id + 1));
    set_motion(p, row);
    p.radius = row[10];
    p.mass = density * 4.0 / 3.0 * std::numbers::pi * p.radius * p.radius * p.radius;
    grains.push_back(p);
  }
  if (grains.empty()) throw FormatError("no grains in " + file.string());
  return grains;
}

void read_motion(const std::filesystem::path& file, std::vector<Particle>& grains) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);)
    if (const auto row = numbers_of(line); row.size() >= 10) rows.push_back(row);
  std::sort(rows.begin(), rows.end());
  if (rows.size() != grains.size())
    throw FormatError(file.string() + " has " + std::to_string(rows.size()) +
                      " grains instead of " + std::to_string(grains.size()));
  const double first = rows.front()[0];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i][0] != first + static_cast<double>(i))
      throw FormatError(file.string() + " lacks a grain");
    set_motion(grains[i], rows[i]);
  }
}

void write_data_file(const std::filesystem::path& file, const Case& input,
                     const std::vector<Particle>& grains) {
  // Walls are planes; the region reaches beyond them, and over the wheel, so that nothing is lost.
  const double margin = 0.001;
  double top = 0.0;
  for (const Particle& p : grains) top = std::max(top, p.position.z + p.radius);
  top += input.wheel.diameter;  // 0 without a wheel
  std::ofstream out = open(file);
  out << "settled bed\n\n" << grains.size() << " atoms\n1 atom types\n\n";
  out << -margin << ' ' << input.box.length + margin << " xlo xhi\n";
  out << -margin << ' ' << input.box.width + margin << " ylo yhi\n";
  out << -margin << ' ' << top + margin << " zlo zhi\n\nAtoms\n\n";
  for (const Particle& p : grains)
    out << p.id + 1 << " 1 " << 2.0 * p.radius << ' ' << input.grains.density << ' ' << p.position.x
        << ' ' << p.position.y << ' ' << p.position.z << '\n';
  if (!out.flush()) throw StorageError("cannot write " + file.string());
}

}  // namespace grouser::bench
