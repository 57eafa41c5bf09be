// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace grouser::diagnosis {

/// Everything a model may be told. The order is that of kSettings.
enum class Setting : std::size_t {
  // Of the experiment; recordings give them with uncertainties.
  kDiameter,
  kParticleDensity,
  kFluidDensity,
  kViscosity,
  kGravity,
  kRestitution,
  kContainerWidth,
  kReleaseGap,
  kReleaseSpeed,
  kTrigger,
  // Amplitudes of physics: 0 = off, 1 = textbook theory.
  kDragInertia,
  kAddedMass,
  kBasset,
  kLubrication,
  kSideWall,
  // Influences without a theory value: 0 = off.
  kAmbientFlow,
  kReleaseForce,
  kReleaseForceTime,
  kVibration,
  kVibrationFrequency,
  kVibrationPhase,
  // Numerics: 1 = the step the model takes by itself.
  kStepFactor,
  // Of one sensor each.
  kGain,
  kZero,
  kLag,
  kFilter,
  kDrift,
  kClip,
};

enum class SettingKind { kExperiment, kAmplitude, kInfluence, kNumerics, kSensor };

/// One line of the table of settings: a new one is one enumerator and one line.
struct SettingEntry {
  Setting id;
  const char* name;  ///< as in recordings and baselines
  const char* unit;  ///< SI; of a sensor's zero and drift, the channel's unit takes part
  SettingKind kind;
  double off;  ///< value where it has no effect, or which is taken when nothing is said
  const char* meaning;
};

inline constexpr std::array<SettingEntry, 28> kSettings{{
    {Setting::kDiameter, "diameter", "m", SettingKind::kExperiment, 0.0, "of the sphere"},
    {Setting::kParticleDensity, "particle_density", "kg m-3", SettingKind::kExperiment, 0.0,
     "of the sphere"},
    {Setting::kFluidDensity, "fluid_density", "kg m-3", SettingKind::kExperiment, 0.0,
     "of the fluid"},
    {Setting::kViscosity, "viscosity", "Pa s", SettingKind::kExperiment, 0.0,
     "dynamic, of the fluid at the temperature of the run"},
    {Setting::kGravity, "gravity", "m s-2", SettingKind::kExperiment, 9.81, "downward positive"},
    {Setting::kRestitution, "restitution", "1", SettingKind::kExperiment, 0.0,
     "speed after over speed before a contact with the floor, dry"},
    {Setting::kContainerWidth, "container_width", "m", SettingKind::kExperiment, 0.0,
     "diameter or side of the container; 0 = wide"},
    {Setting::kReleaseGap, "release_gap", "m", SettingKind::kExperiment, 0.0,
     "gap below the sphere when it is let go"},
    {Setting::kReleaseSpeed, "release_speed", "m s-1", SettingKind::kExperiment, 0.0,
     "downward, when it is let go"},
    {Setting::kTrigger, "trigger", "s", SettingKind::kExperiment, 0.0,
     "time of the release on the recording's clock"},
    {Setting::kDragInertia, "drag_inertia", "1", SettingKind::kAmplitude, 0.0,
     "drag above Stokes' at finite Reynolds number"},
    {Setting::kAddedMass, "added_mass", "1", SettingKind::kAmplitude, 0.0,
     "fluid accelerated with the sphere"},
    {Setting::kBasset, "basset", "1", SettingKind::kAmplitude, 0.0,
     "history of the boundary layer"},
    {Setting::kLubrication, "lubrication", "1", SettingKind::kAmplitude, 0.0,
     "film squeezed between sphere and floor"},
    {Setting::kSideWall, "side_wall", "1", SettingKind::kAmplitude, 0.0,
     "drag raised by the container's side"},
    {Setting::kAmbientFlow, "ambient_flow", "m s-1", SettingKind::kInfluence, 0.0,
     "steady flow of the fluid, upward positive"},
    {Setting::kReleaseForce, "release_force", "1", SettingKind::kInfluence, 0.0,
     "upward force at the release over the buoyant weight; it fades exponentially"},
    {Setting::kReleaseForceTime, "release_force_time", "s", SettingKind::kInfluence, 0.1,
     "time in which the release force fades to 1/e"},
    {Setting::kVibration, "vibration", "m", SettingKind::kInfluence, 0.0,
     "amplitude of the camera's or container's vertical swing"},
    {Setting::kVibrationFrequency, "vibration_frequency", "s-1", SettingKind::kInfluence, 1.0,
     "of that swing"},
    {Setting::kVibrationPhase, "vibration_phase", "1", SettingKind::kInfluence, 0.0,
     "of that swing at time 0, in radians"},
    {Setting::kStepFactor, "step_factor", "1", SettingKind::kNumerics, 1.0,
     "time step over the one the model takes by itself"},
    {Setting::kGain, "gain", "1", SettingKind::kSensor, 0.0, "relative error of the scale"},
    {Setting::kZero, "zero", "1", SettingKind::kSensor, 0.0, "offset, in the channel's SI unit"},
    {Setting::kLag, "lag", "s", SettingKind::kSensor, 0.0, "time constant of a first-order lag"},
    {Setting::kFilter, "filter", "s", SettingKind::kSensor, 0.0,
     "length of a centred moving average"},
    {Setting::kDrift, "drift", "s-1", SettingKind::kSensor, 0.0,
     "of the zero, in the channel's SI unit per second"},
    {Setting::kClip, "clip", "1", SettingKind::kSensor, 0.0,
     "share of the channel's range, from the top, that is cut off"},
}};
inline constexpr std::size_t kSettingCount = kSettings.size();

constexpr std::size_t index_of(Setting setting) { return static_cast<std::size_t>(setting); }
constexpr const SettingEntry& entry_of(Setting setting) { return kSettings[index_of(setting)]; }

/// The setting of that name, if there is one. Local.
std::optional<Setting> find_setting(const std::string& name);

/// What can be recorded as a series.
enum class Signal : std::size_t { kGap, kSettlingSpeed, kVerticalVelocity };

/// One line of the vocabulary of series: a new observable is one enumerator and one line.
struct SignalEntry {
  Signal id;
  const char* name;
  const char* unit;  ///< SI
  const char* heading;
  const char* positive;    ///< what positive means
  const char* shown_unit;  ///< in plots and tables for people
  double shown_scale;      ///< shown = SI * shown_scale
};

inline constexpr std::array<SignalEntry, 3> kSignals{{
    {Signal::kGap, "gap", "m", "Gap", "sphere above the floor", "mm", 1e3},
    {Signal::kSettlingSpeed, "settling_speed", "m s-1", "Settling speed", "downward", "mm/s", 1e3},
    {Signal::kVerticalVelocity, "vertical_velocity", "m s-1", "Vertical velocity", "upward", "mm/s",
     1e3},
}};

constexpr const SignalEntry& entry_of(Signal signal) {
  return kSignals[static_cast<std::size_t>(signal)];
}

/// The observable of that name, if there is one. Local.
std::optional<Signal> find_signal(const std::string& name);

}  // namespace grouser::diagnosis
