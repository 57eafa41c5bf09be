// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace grouser {

using PlotPoint = std::pair<double, double>;

/// Numbered axis whose ends are ticks.
struct PlotAxis {
  double low = 0.0;
  double high = 1.0;
  double step = 1.0;
  int decimals = 0;  ///< that tell the ticks apart

  std::vector<double> ticks() const;
};

/// Axis over [low, high] with about `target` steps of 1, 2 or 5 times a power of ten. Ends that are
/// equal, reversed or not finite give an axis around what is left of them. Local.
PlotAxis nice_axis(double low, double high, int target = 5);

/// Lowest and highest of the finite values seen.
class ValueRange {
 public:
  void add(double value);
  void add(const std::vector<double>& values);
  bool is_empty() const { return low_ > high_; }
  double low() const { return low_; }    ///< 0 when empty
  double high() const { return high_; }  ///< 1 when empty

 private:
  double low_ = 1.0;
  double high_ = 0.0;
};

/// Thins a curve to about `columns` columns, keeping the least and largest value of each, so that
/// peaks stay. Points must rise in x; points that are not finite are left out. Local.
std::vector<PlotPoint> thin_curve(const std::vector<PlotPoint>& curve, std::size_t columns);

enum class Marker { kDot, kRing, kDiamond, kSquare, kTriangle };

/// One plot as inline SVG. Colours come from CSS classes, so that the page decides on light, dark
/// and paper. All coordinates given are values on the axes; what is not finite is not drawn.
class Plot {
 public:
  struct Style {
    std::string css_class;
    std::string data;  ///< value of the attribute data-series, plain text
  };

  /// @param title, description read by screen readers; plain text
  /// @param x_label, y_label plain text with unit
  Plot(std::string title, std::string description, PlotAxis x, PlotAxis y, std::string x_label,
       std::string y_label);

  /// Height of the drawing in its own units, 480 wide; 320 unless said otherwise. Set it before
  /// drawing.
  void set_height(double height) { height_ = height; }

  void shade(double x_from, double x_to, const Style& style, const std::string& hover);
  void line(const std::vector<PlotPoint>& points, const Style& style);
  /// Area between two curves over the same x. @param band x and the two values
  void band(const std::vector<PlotPoint>& low, const std::vector<PlotPoint>& high,
            const Style& style);
  /// @param hover shown when the pointer rests on it; plain text
  void marker(PlotPoint at, Marker shape, const Style& style, const std::string& hover);
  void error_bar(PlotPoint at, double half_height, const Style& style);
  /// The zero line of the vertical axis, if it is inside.
  void zero_line();

  std::string svg() const;

 private:
  double x_of(double value) const;
  double y_of(double value) const;
  std::string path_of(const std::vector<PlotPoint>& points, char first) const;
  std::string grid() const;

  std::string title_;
  std::string description_;
  PlotAxis x_;
  PlotAxis y_;
  std::string x_label_;
  std::string y_label_;
  double height_ = 320.0;
  std::string body_;
};

/// The marker alone around (x, y) in drawing units, for plots and legends. Local.
std::string marker_svg(double x, double y, Marker shape, const Plot::Style& style,
                       const std::string& hover);

}  // namespace grouser
