// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"

#include <udunits2.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

namespace grouser {
namespace {

struct SystemDeleter {
  void operator()(ut_system* system) const { ut_free_system(system); }
};
struct UnitDeleter {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
struct ConverterDeleter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using Unit = std::unique_ptr<ut_unit, UnitDeleter>;

ut_system* unit_system() {
  static const std::unique_ptr<ut_system, SystemDeleter> system = [] {
    ut_set_error_message_handler(ut_ignore);
    return std::unique_ptr<ut_system, SystemDeleter>(ut_read_xml(nullptr));
  }();
  if (!system) throw std::runtime_error("the UDUNITS-2 unit database is not installed");
  return system.get();
}

Unit parse_unit(const std::string& text) {
  return Unit(ut_parse(unit_system(), text.c_str(), UT_UTF8));
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// hh:mm:ss as batch systems write it.
bool parse_clock(const std::string& text, double& seconds) {
  int hours = 0;
  int minutes = 0;
  int whole = 0;
  int used = 0;
  if (std::sscanf(text.c_str(), "%d:%2d:%2d%n", &hours, &minutes, &whole, &used) != 3) return false;
  if (used != static_cast<int>(text.size()) || hours < 0 || minutes > 59 || whole > 59)
    return false;
  seconds = hours * 3600.0 + minutes * 60.0 + whole;
  return true;
}

}  // namespace

double parse_quantity(const std::string& raw, const std::string& si_unit) {
  const std::string text = trimmed(raw);
  double number = 0.0;
  if (si_unit == "s" && parse_clock(text, number)) return number;
  const char* begin = text.c_str();
  if (*begin == '+') ++begin;
  const char* end = text.c_str() + text.size();
  const auto [rest, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || !std::isfinite(number))
    throw std::invalid_argument("'" + text + "' is not a number" +
                                (si_unit == "1" ? "" : " with a unit"));
  const std::string unit_text = trimmed(std::string(rest, end));
  if (unit_text.empty()) {
    if (si_unit == "1") return number;
    throw std::invalid_argument("'" + text + "' has no unit, and a unit like '" + si_unit +
                                "' is needed");
  }
  const Unit from = parse_unit(unit_text);
  if (!from) throw std::invalid_argument("'" + unit_text + "' is not a unit");
  const Unit to = parse_unit(si_unit);
  if (!to || !ut_are_convertible(from.get(), to.get()))
    throw std::invalid_argument("unit '" + unit_text + "' cannot be turned into '" + si_unit + "'");
  const std::unique_ptr<cv_converter, ConverterDeleter> converter(
      ut_get_converter(from.get(), to.get()));
  const double converted = converter ? cv_convert_double(converter.get(), number) : NAN;
  if (!std::isfinite(converted))
    throw std::invalid_argument("'" + text + "' is too large to be expressed in '" + si_unit + "'");
  return converted;
}

std::string format_number(double value) {
  char text[64];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return error == std::errc() ? std::string(text, end) : std::string("nan");
}

std::string format_quantity(double value, const std::string& si_unit) {
  return si_unit == "1" ? format_number(value) : format_number(value) + " " + si_unit;
}

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace grouser
