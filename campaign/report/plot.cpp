// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/plot.hpp"

#include <algorithm>
#include <cmath>

#include "campaign/report/html.hpp"

namespace grouser {
namespace {

constexpr double kWidth = 480.0;
constexpr double kLeft = 52.0;
constexpr double kRight = 22.0;
constexpr double kTop = 34.0;
constexpr double kBottom = 54.0;

std::string attributes(const Plot::Style& style) {
  return " class=\"" + style.css_class + "\"" +
         (style.data.empty() ? "" : " data-series=\"" + escape_html(style.data) + "\"");
}

std::string at(const char* name_x, double x, const char* name_y, double y) {
  return std::string(" ") + name_x + "=\"" + coordinate(x) + "\" " + name_y + "=\"" +
         coordinate(y) + "\"";
}

std::string polygon(const std::vector<PlotPoint>& corners) {
  std::string path;
  for (const auto& [x, y] : corners)
    path += (path.empty() ? "M" : "L") + coordinate(x) + " " + coordinate(y);
  return path + "Z";
}

/// Step of 1, 2 or 5 times a power of ten that cuts `span` into about `target` parts; the bounds
/// are the geometric means between the choices.
double nice_step(double span, int target) {
  const double raw = span / target;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  return power * (lead < 1.414 ? 1.0 : lead < 3.162 ? 2.0 : lead < 7.071 ? 5.0 : 10.0);
}

}  // namespace

std::vector<double> PlotAxis::ticks() const {
  std::vector<double> values;
  const auto count = static_cast<int>(std::lround((high - low) / step));
  for (int i = 0; i <= count; ++i) values.push_back(low + i * step);
  return values;
}

PlotAxis nice_axis(double low, double high, int target) {
  if (!std::isfinite(low)) low = std::isfinite(high) ? high : 0.0;
  if (!std::isfinite(high)) high = low;
  if (low > high) std::swap(low, high);
  if (high - low <= 1e-9 * std::max(std::abs(low), std::abs(high))) {
    const double pad = low == 0.0 ? 1.0 : 0.1 * std::abs(low);
    low -= pad;
    high += pad;
  }
  PlotAxis axis;
  axis.step = nice_step(high - low, target);
  // A value that is a tick but for rounding must not open another step.
  axis.low = std::floor(low / axis.step + 1e-9) * axis.step;
  axis.high = std::ceil(high / axis.step - 1e-9) * axis.step;
  axis.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(axis.step) + 1e-9)));
  return axis;
}

void ValueRange::add(double value) {
  if (!std::isfinite(value)) return;
  const bool was_empty = is_empty();
  low_ = was_empty ? value : std::min(low_, value);
  high_ = was_empty ? value : std::max(high_, value);
}

void ValueRange::add(const std::vector<double>& values) {
  for (const double value : values) add(value);
}

std::vector<PlotPoint> thin_curve(const std::vector<PlotPoint>& curve, std::size_t columns) {
  std::vector<PlotPoint> finite;
  for (const PlotPoint& point : curve)
    if (std::isfinite(point.first) && std::isfinite(point.second)) finite.push_back(point);
  if (finite.size() <= 2 * columns || columns == 0) return finite;
  std::vector<PlotPoint> thin;
  for (std::size_t column = 0; column < columns; ++column) {
    const auto from =
        finite.begin() + static_cast<std::ptrdiff_t>(column * finite.size() / columns);
    const auto to =
        finite.begin() + static_cast<std::ptrdiff_t>((column + 1) * finite.size() / columns);
    auto [low, high] = std::minmax_element(
        from, to, [](const PlotPoint& a, const PlotPoint& b) { return a.second < b.second; });
    if (high < low) std::swap(low, high);
    thin.push_back(*low);
    if (high != low) thin.push_back(*high);
  }
  return thin;
}

Plot::Plot(std::string title, std::string description, PlotAxis x, PlotAxis y, std::string x_label,
           std::string y_label)
    : title_(std::move(title)),
      description_(std::move(description)),
      x_(x),
      y_(y),
      x_label_(std::move(x_label)),
      y_label_(std::move(y_label)) {}

double Plot::x_of(double value) const {
  return kLeft + (value - x_.low) / (x_.high - x_.low) * (kWidth - kLeft - kRight);
}

double Plot::y_of(double value) const {
  return height_ - kBottom - (value - y_.low) / (y_.high - y_.low) * (height_ - kTop - kBottom);
}

std::string Plot::path_of(const std::vector<PlotPoint>& points, char first) const {
  std::string path;
  for (const auto& [x, y] : points) {
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    path += (path.empty() ? first : 'L') + coordinate(x_of(x)) + " " + coordinate(y_of(y));
  }
  return path;
}

void Plot::shade(double x_from, double x_to, const Style& style, const std::string& hover) {
  if (!std::isfinite(x_from) || !std::isfinite(x_to)) return;
  const double left = x_of(std::clamp(x_from, x_.low, x_.high));
  const double right = x_of(std::clamp(x_to, x_.low, x_.high));
  body_ += "<rect" + attributes(style) + at("x", left, "y", kTop) +
           at("width", right - left, "height", height_ - kTop - kBottom) + "><title>" +
           escape_html(hover) + "</title></rect>\n";
}

void Plot::line(const std::vector<PlotPoint>& points, const Style& style) {
  const std::string path = path_of(points, 'M');
  if (!path.empty()) body_ += "<path" + attributes(style) + " d=\"" + path + "\"/>\n";
}

void Plot::band(const std::vector<PlotPoint>& low, const std::vector<PlotPoint>& high,
                const Style& style) {
  const std::vector<PlotPoint> back(high.rbegin(), high.rend());
  const std::string path = path_of(low, 'M') + path_of(back, 'L');
  if (low.size() > 1) body_ += "<path" + attributes(style) + " d=\"" + path + "Z\"/>\n";
}

void Plot::marker(PlotPoint where, Marker shape, const Style& style, const std::string& hover) {
  if (!std::isfinite(where.first) || !std::isfinite(where.second)) return;
  body_ += marker_svg(x_of(where.first), y_of(where.second), shape, style, hover);
}

void Plot::error_bar(PlotPoint where, double half_height, const Style& style) {
  if (!std::isfinite(where.first) || !std::isfinite(where.second) || !(half_height > 0.0)) return;
  const double x = x_of(where.first);
  const double top = y_of(where.second + half_height);
  const double bottom = y_of(where.second - half_height);
  body_ += "<path" + attributes(style) + " d=\"M" + coordinate(x - 4) + " " + coordinate(top) +
           "h8m-4 0V" + coordinate(bottom) + "m-4 0h8\"/>\n";
}

void Plot::zero_line() {
  if (y_.low < 0.0 && y_.high > 0.0)
    body_ += "<path class=\"zero\" d=\"M" + coordinate(kLeft) + " " + coordinate(y_of(0.0)) + "H" +
             coordinate(kWidth - kRight) + "\"/>\n";
}

std::string Plot::grid() const {
  std::string lines;
  std::string labels;
  const double bottom = height_ - kBottom;
  for (const double tick : y_.ticks()) {
    const std::string y = coordinate(y_of(tick));
    lines += "M" + coordinate(kLeft) + " " + y + "H" + coordinate(kWidth - kRight);
    labels += "<text class=\"tick end\"" + at("x", kLeft - 7, "y", y_of(tick) + 4.5) + ">" +
              shown_number(tick, y_.decimals) + "</text>";
  }
  for (const double tick : x_.ticks()) {
    lines += "M" + coordinate(x_of(tick)) + " " + coordinate(bottom) + "v5";
    labels += "<text class=\"tick middle\"" + at("x", x_of(tick), "y", bottom + 21) + ">" +
              shown_number(tick, x_.decimals) + "</text>";
  }
  labels += "<text class=\"label\" x=\"0\" y=\"15\">" + escape_html(y_label_) + "</text>";
  labels += "<text class=\"label end\"" + at("x", kWidth - kRight, "y", height_ - 6) + ">" +
            escape_html(x_label_) + "</text>";
  return "<path class=\"grid\" d=\"" + lines + "\"/>\n" + labels + "\n";
}

std::string Plot::svg() const {
  return "<svg class=\"plot\" role=\"img\" viewBox=\"0 0 " + coordinate(kWidth) + " " +
         coordinate(height_) + "\" aria-label=\"" + escape_html(title_) + "\">\n<title>" +
         escape_html(title_) + "</title>\n<desc>" + escape_html(description_) + "</desc>\n" +
         grid() + body_ + "</svg>\n";
}

std::string marker_svg(double x, double y, Marker shape, const Plot::Style& style,
                       const std::string& hover) {
  const std::string title =
      hover.empty() ? std::string() : "<title>" + escape_html(hover) + "</title>";
  constexpr double kHalf = 5.0;
  switch (shape) {
    case Marker::kDot:
    case Marker::kRing:
      return "<circle" + attributes(style) + at("cx", x, "cy", y) +
             (shape == Marker::kDot ? " r=\"3.5\">" : " r=\"5.5\">") + title + "</circle>\n";
    case Marker::kDiamond:
      return "<path" + attributes(style) + " d=\"" +
             polygon({{x, y - 7}, {x + 7, y}, {x, y + 7}, {x - 7, y}}) + "\">" + title +
             "</path>\n";
    case Marker::kSquare:
      return "<path" + attributes(style) + " d=\"" +
             polygon({{x - kHalf, y - kHalf},
                      {x + kHalf, y - kHalf},
                      {x + kHalf, y + kHalf},
                      {x - kHalf, y + kHalf}}) +
             "\">" + title + "</path>\n";
    case Marker::kTriangle:
      return "<path" + attributes(style) + " d=\"" +
             polygon({{x, y - 6}, {x + 6, y + 5}, {x - 6, y + 5}}) + "\">" + title + "</path>\n";
  }
  return "";
}

}  // namespace grouser
