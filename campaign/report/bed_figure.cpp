// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "campaign/report/colour_map.hpp"
#include "campaign/report/figures.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/plot.hpp"

namespace grouser {
namespace {

constexpr std::size_t kColours = 32;
constexpr double kMillimetre = 1e-3;

std::size_t colour_class(double displacement, double scale) {
  const double share = std::clamp(displacement / scale, 0.0, 1.0);
  return std::min(kColours - 1, static_cast<std::size_t>(share * kColours));
}

std::string colour_text(std::size_t colour) {
  return hex_of(colour_at((static_cast<double>(colour) + 0.5) / kColours));
}

/// Grains grouped by colour, the least displaced first.
std::string grains_svg(const BedSlice& slice, double scale, double top) {
  std::array<std::string, kColours> groups;
  const double enlarged = std::sqrt(static_cast<double>(slice.every)) / kMillimetre;
  for (const BedSlice::Grain& grain : slice.grains)
    groups[colour_class(grain.displacement, scale)] +=
        "<circle cx=\"" + coordinate(grain.x / kMillimetre) + "\" cy=\"" +
        coordinate((top - grain.z) / kMillimetre) + "\" r=\"" +
        coordinate(grain.radius * enlarged) + "\"/>";
  std::string svg = "<g class=\"grains\" data-series=\"grains\">\n";
  for (std::size_t colour = 0; colour < kColours; ++colour)
    if (!groups[colour].empty())
      svg += "<g fill=\"" + colour_text(colour) + "\">" + groups[colour] + "</g>\n";
  return svg + "</g>\n";
}

std::string wheel_svg(const BedSlice& slice, double top) {
  std::string path;
  for (const auto& [x, z] : slice.wheel)
    path += (path.empty() ? "M" : "L") + coordinate(x / kMillimetre) + " " +
            coordinate((top - z) / kMillimetre);
  if (path.empty()) return "";
  return "<path class=\"wheel\" data-series=\"wheel\" d=\"" + path + "Z\"/>\n";
}

/// The picture ends a little above the axle: the upper half of the wheel says nothing.
double top_of(const BedSlice& slice) {
  double top = slice.wall_height;
  ValueRange wheel;
  for (const auto& [x, z] : slice.wheel) wheel.add(z);
  if (!wheel.is_empty()) top = std::max(top, wheel.low() + 0.55 * (wheel.high() - wheel.low()));
  for (const BedSlice::Grain& grain : slice.grains) top = std::max(top, grain.z + grain.radius);
  return top;
}

double length_of(const BedSlice& slice) {
  double length = slice.box_length;
  for (const BedSlice::Grain& grain : slice.grains)
    length = std::max(length, grain.x + grain.radius);
  return length;
}

}  // namespace

double displacement_scale(const ReportData& data) {
  std::vector<double> displacements;
  for (const RunData& run : data.runs)
    if (!run.is_bed)
      for (const BedSlice::Grain& grain : run.slice.grains)
        displacements.push_back(grain.displacement);
  const double high = quantile_of(std::move(displacements), 0.98);
  return high > 0.0 ? nice_axis(0.0, high, 4).high : (high == 0.0 ? kMillimetre : 0.0);
}

std::string bed_figure(const RunData& run, double scale) {
  const BedSlice& slice = run.slice;
  const double margin = 0.01 * length_of(slice);
  const double top = top_of(slice) + margin;
  const double width = (length_of(slice) + 2.0 * margin) / kMillimetre;
  const double height = (top + margin) / kMillimetre;
  const std::string title = escape_html(run.label + ": bed and wheel, coloured by displacement");
  const std::string floor = coordinate(top / kMillimetre);
  const std::string wall = coordinate((top - slice.wall_height) / kMillimetre);
  return "<svg class=\"bed\" role=\"img\" viewBox=\"" + coordinate(-margin / kMillimetre) + " 0 " +
         coordinate(width) + " " + coordinate(height) + "\" aria-label=\"" + title +
         "\">\n<title>" + title + "</title>\n<desc>" +
         shown_count(static_cast<long long>(slice.grains.size())) +
         " grains within a quarter of the wheel's width of the mid-plane.</desc>\n" +
         grains_svg(slice, scale, top) + wheel_svg(slice, top) + "<path class=\"box\" d=\"M0 " +
         wall + "V" + floor + "H" + coordinate(slice.box_length / kMillimetre) + "V" + wall +
         "\"/>\n</svg>\n";
}

std::string displacement_legend(double scale) {
  constexpr double kWidth = 480.0;
  constexpr double kInset = 24.0;
  const double step = (kWidth - 2.0 * kInset) / kColours;
  std::string svg =
      "<svg class=\"scale\" role=\"img\" viewBox=\"0 0 480 64\" aria-label=\"Colours of "
      "displacement\">\n<text class=\"label\" x=\"24\" y=\"14\">Displacement since the start of "
      "the "
      "run [mm]</text>\n";
  for (std::size_t colour = 0; colour < kColours; ++colour)
    svg += "<rect x=\"" + coordinate(kInset + static_cast<double>(colour) * step) +
           "\" y=\"22\" width=\"" + coordinate(step + 0.5) + "\" height=\"14\" fill=\"" +
           colour_text(colour) + "\"/>";
  const PlotAxis axis = nice_axis(0.0, scale / kMillimetre, 4);
  for (const double tick : axis.ticks()) {
    const double x = kInset + tick * kMillimetre / scale * (kWidth - 2.0 * kInset);
    if (x > kWidth - kInset + 0.5) continue;
    const bool is_end = x > kWidth - kInset - 0.5;
    svg += "<text class=\"tick middle\" x=\"" + coordinate(x) + "\" y=\"54\">" +
           (is_end ? "≥ " : "") + shown_number(tick, axis.decimals) + "</text>";
  }
  return svg + "\n</svg>\n";
}

}  // namespace grouser
