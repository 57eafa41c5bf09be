// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/run_output.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "campaign/report/csv.hpp"

namespace grouser {
namespace {

std::size_t column_of(const CsvTable& table, const std::string& name, const std::string& source) {
  const auto column = table.column(name);
  if (!column) throw FormatError(source + ": column '" + name + "' is missing");
  return *column;
}

/// A grain is drawn only if it is a circle somewhere: a damaged row must not spoil the picture.
bool is_drawable(const BedSlice::Grain& grain) {
  return std::isfinite(grain.x) && std::isfinite(grain.z) && grain.radius > 0.0 &&
         std::isfinite(grain.radius) && std::isfinite(grain.displacement);
}

}  // namespace

RunSeries parse_series(const std::string& text, const std::string& source) {
  // The engine ends every row with a line end: what follows the last one is half a row.
  const CsvTable table = parse_csv(text.substr(0, text.rfind('\n') + 1));
  RunSeries series;
  if (table.header.empty()) return series;
  const std::size_t phase = column_of(table, "phase", source);
  std::vector<std::pair<std::size_t, std::vector<double>*>> columns{
      {column_of(table, "time [s]", source), &series.time},
      {column_of(table, "travel [m]", source), &series.travel},
      {column_of(table, "forward_speed [m s-1]", source), &series.forward_speed},
      {column_of(table, "spin [rad s-1]", source), &series.spin}};
  for (const ObservableEntry& entry : kObservables)
    columns.emplace_back(column_of(table, entry.series_column, source),
                         &series.observables[index_of(entry.id)]);
  for (const std::vector<std::string>& row : table.rows) {
    if (row.size() != table.header.size()) continue;
    series.phase.push_back(row[phase]);
    for (const auto& [column, values] : columns) values->push_back(number_of(row[column]));
  }
  return series;
}

TrackSeries parse_track(const std::string& text, const std::string& source) {
  const CsvTable table = parse_csv(text.substr(0, text.rfind('\n') + 1));
  TrackSeries track;
  if (table.header.empty()) return track;
  const std::vector<std::pair<std::size_t, std::vector<double>*>> columns{
      {column_of(table, "time [s]", source), &track.time},
      {column_of(table, "gap [m]", source), &track.gap},
      {column_of(table, "velocity_z [m s-1]", source), &track.velocity}};
  for (const std::vector<std::string>& row : table.rows)
    if (row.size() == table.header.size())
      for (const auto& [column, values] : columns) values->push_back(number_of(row[column]));
  return track;
}

BedSlice parse_slice(const std::string& text, const std::string& source, std::size_t max_grains) {
  const CsvTable table = parse_csv(text.substr(0, text.rfind('\n') + 1));
  BedSlice slice;
  if (table.header.empty()) return slice;
  const std::size_t kind = column_of(table, "kind", source);
  const std::size_t x = column_of(table, "x [m]", source);
  const std::size_t z = column_of(table, "z [m]", source);
  const std::size_t radius = column_of(table, "radius [m]", source);
  const std::size_t displacement = column_of(table, "displacement [m]", source);
  for (const std::vector<std::string>& row : table.rows) {
    if (row.size() != table.header.size()) continue;
    const BedSlice::Grain grain{number_of(row[x]), number_of(row[z]), number_of(row[radius]),
                                number_of(row[displacement])};
    if (row[kind] == "grain" && is_drawable(grain)) slice.grains.push_back(grain);
    if (!std::isfinite(grain.x) || !std::isfinite(grain.z)) continue;
    if (row[kind] == "wheel") slice.wheel.emplace_back(grain.x, grain.z);
    if (row[kind] == "box") {
      slice.box_length = grain.x;
      slice.wall_height = grain.z;
    }
  }
  slice.every = std::max<std::size_t>(1, (slice.grains.size() + max_grains - 1) / max_grains);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < slice.grains.size(); i += slice.every)
    slice.grains[kept++] = slice.grains[i];
  slice.grains.resize(kept);
  return slice;
}

}  // namespace grouser
