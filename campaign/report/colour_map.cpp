// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/colour_map.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr double kDarkest = 0.30;
constexpr double kLightest = 0.93;
constexpr double kFirstHue = 305.0;  // violet [degrees]
constexpr double kLastHue = 105.0;   // yellow
constexpr double kChroma = 0.14;

Colour linear_from_oklab(double lightness, double a, double b) {
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool is_displayable(const Colour& linear) {
  return std::all_of(linear.begin(), linear.end(),
                     [](double part) { return part >= 0.0 && part <= 1.0; });
}

double encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double decode(double part) {
  return part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
}

}  // namespace

Colour colour_at(double share) {
  share = std::isnan(share) ? 0.0 : std::clamp(share, 0.0, 1.0);
  const double lightness = kDarkest + (kLightest - kDarkest) * share;
  const double hue = (kFirstHue + (kLastHue - kFirstHue) * share) * std::acos(-1.0) / 180.0;
  // Less chroma where the screen cannot show it: lightness, which carries the value, stays exact.
  for (double chroma = kChroma; chroma > 0.0; chroma -= 0.002) {
    const Colour linear =
        linear_from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
    if (is_displayable(linear)) return {encode(linear[0]), encode(linear[1]), encode(linear[2])};
  }
  const double grey = encode(std::pow(lightness, 3));
  return {grey, grey, grey};
}

double lightness_of(const Colour& colour) {
  const double r = decode(colour[0]);
  const double g = decode(colour[1]);
  const double b = decode(colour[2]);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

std::string hex_of(const Colour& colour) {
  const auto byte = [](double part) {
    return static_cast<int>(std::lround(255.0 * std::clamp(part, 0.0, 1.0)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(colour[0]), byte(colour[1]), byte(colour[2]));
}

}  // namespace grouser
