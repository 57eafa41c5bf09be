// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "base/case.hpp"

namespace grouser {

/// Above this share of the Rayleigh time a step may let contacts gain energy.
inline constexpr double kSoundRayleighShare = 0.3;

/// Steps to the shortest collision that an automatic step leaves: 8, or more for a restitution e
/// under 0.09 in any contact of the case, 1.8 e^(-0.6), because there the damping is stiffer than
/// the spring. Measured on the leapfrog scheme with the damping of hertz_mindlin, wherever in a
/// step the contact begins: an elastic rebound is off by 0.5 % at most, 0.5 comes out as 0.476 to
/// 0.522, 0.05 as under 0.11 and 0.01 as under 0.02. With 8 steps, 0.01 would come out as up
/// to 2.5.
double collision_steps(const Case& input);

/// With fewer than this share of `collision_steps` contacts may gain energy.
inline constexpr double kSoundStepShare = 0.625;

/// The shortest collision that a case implies.
struct Impact {
  double time = 0.0;     ///< from touch to parting [s]
  double speed = 0.0;    ///< of the two against each other [m s-1]
  double overlap = 0.0;  ///< largest, over the radius of the smallest grain [1]
  std::string pair;      ///< "two grains", "a grain and the box", "a grain and the wheel"
};

/// Shortest time in which a shear wave rounds a grain, Rayleigh's surface wave [s]. Knows the
/// grains alone. 0 without a size curve. Source: Sheng, Lawrence, Briscoe, Thornton 2004, eq. 5.
double rayleigh_time(const Case& input);

/// Fastest speed that the case prescribes [m s-1]: of a bed, free fall through its loose filling,
/// of placed grains, free fall to the floor; with a wheel, forward speed and rim speed added up.
/// What the soil does beyond is not known here.
double fastest_speed(const Case& input);

/// Shortest collision at `fastest_speed`, of the smallest grains with each other, the box and the
/// wheel, without damping, which makes it longer. To four digits, so that the last bit of no
/// machine's mathematical library gets into the step. Zeros without a size curve.
/// Source: Johnson 1985, eq. 11.24; Landau and Lifshitz, Theory of Elasticity, section 9.
Impact shortest_collision(const Case& input);

/// The longest step that a case allows its grains [s]: given, or the smaller of its fraction of the
/// Rayleigh time and the shortest collision over `collision_steps`. Local.
double longest_time_step(const Case& input);

/// Time step of a case [s]: the longest, or on a lattice the longest whole part of the lattice's
/// step that is no longer. Local.
double time_step_of(const Case& input);

/// Whether the shortest collision and nothing else sets the step. Local.
bool is_step_of_collision(const Case& input);

/// One line for people: the step, what decided it, and both times. Local.
std::string time_step_text(const Case& input);

/// Rules over the step of a case and of its bed; see FieldVisitor.
void describe_time_step(FieldVisitor& visitor, const Case& input);

/// Warnings over the step of a case and of its bed, at their place in `node`. Local.
std::vector<Problem> time_step_warnings(const YamlNode& node, const Case& input);

}  // namespace grouser
