// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

namespace grouser {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What a report averages, draws and compares. The order is that of kObservables.
enum class Observable : std::size_t {
  kPullCoefficient,
  kGrossCoefficient,
  kSinkage,
  kPull,
  kGrossTractiveEffort,
  kMotionResistance,
  kLoad,
};

/// One line of the table of observables. A new observable is one enumerator and one line.
struct ObservableEntry {
  Observable id;
  const char* name;           ///< as in recordings and CSV headers
  const char* unit;           ///< SI
  const char* series_column;  ///< header of the column in series.csv
  const char* heading;        ///< in the field's words
  const char* shown_unit;     ///< unit in plots and tables for people
  double shown_scale;         ///< shown = SI * shown_scale
  int shown_decimals;
  const char* difference_unit;  ///< word for differences between shown values
};

inline constexpr std::array<ObservableEntry, 7> kObservables{{
    {Observable::kPullCoefficient, "pull_coefficient", "1", "pull_coefficient [1]",
     "Pull coefficient", "%", 100.0, 1, "points"},
    {Observable::kGrossCoefficient, "gross_coefficient", "1", "gross_coefficient [1]",
     "Gross coefficient", "%", 100.0, 1, "points"},
    {Observable::kSinkage, "sinkage", "m", "sinkage [m]", "Sinkage", "mm", 1000.0, 1, "mm"},
    {Observable::kPull, "pull", "N", "pull [N]", "Drawbar pull", "N", 1.0, 1, "N"},
    {Observable::kGrossTractiveEffort, "gross_tractive_effort", "N", "gross_tractive_effort [N]",
     "Gross tractive effort", "N", 1.0, 1, "N"},
    {Observable::kMotionResistance, "motion_resistance", "N", "motion_resistance [N]",
     "Motion resistance", "N", 1.0, 1, "N"},
    {Observable::kLoad, "load", "N", "vertical_force [N]", "Vertical force", "N", 1.0, 1, "N"},
}};
inline constexpr std::size_t kObservableCount = kObservables.size();

constexpr std::size_t index_of(Observable observable) {
  return static_cast<std::size_t>(observable);
}
constexpr const ObservableEntry& entry_of(Observable observable) {
  return kObservables[index_of(observable)];
}
/// The observable of that name, if there is one. Local.
std::optional<Observable> find_observable(const std::string& name);

/// How slip is counted; w is the rim speed omega r, v the forward speed.
enum class SlipDefinition {
  kPowered,  ///< i = 1 - v/w, not defined for the locked wheel
  kBounded,  ///< s = (w - v)/max(w, v), from -1 (locked) to 1 (spinning on the spot)
};

/// Of `powered` or `bounded`; nothing for other words.
std::optional<SlipDefinition> find_slip_definition(const std::string& word);

/// Formula for axis labels, as text.
const char* formula_of(SlipDefinition definition);

/// Slip of a wheel. @param rim_speed omega r [m s-1] @param forward_speed [m s-1]
/// @return slip [1], NaN where the definition has none (powered: rim speed 0 or against the
/// driving direction)
double slip_of(SlipDefinition definition, double rim_speed, double forward_speed);

/// Turns a slip from one definition into the other. [1]
/// @return NaN where the other definition has none
double convert_slip(double slip, SlipDefinition from, SlipDefinition to);

}  // namespace grouser
