// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

// A sphere in a liquid for concealed cases. Shares no code with the engine or the diagnosis: own
// laws, own integrator, the standard library alone.
namespace blind {

struct World {
  // What a laboratory would measure.
  double diameter = 0.01;
  double sphere_density = 2000.0;
  double liquid_density = 1000.0;
  double viscosity = 0.1;
  double restitution = 0.5;
  double width = 0.0;  // of the container, 0 = wide
  double drop = 0.1;   // gap at the release
  double start = 0.0;  // time of the release
  // Known to be there or concealed; 0 = not there.
  double inertia_drag = 0.0;  // Schiller and Naumann
  double virtual_mass = 0.0;  // of half the displaced liquid
  double memory = 0.0;        // Basset's history force
  double film = 0.0;          // floor, Brenner's series
  double side = 0.0;          // container, Haberman and Sayre
  double current = 0.0;       // steady upward flow
  double grip = 0.0;          // release force over the buoyant weight
  double grip_time = 0.1;
  double swing = 0.0;  // of the camera [m]
  double swing_frequency = 1.0;
  double swing_phase = 0.0;
  // Of no catalogue.
  double stratification = 0.0;  // relative growth of the liquid's density over the drop
  double thinning = 0.0;        // relative loss of viscosity at the speed of a free fall
  double magnet = 0.0;          // force over the weight at half the drop, a bump in height
  double roll = 0.0;            // upward current that is largest at half the drop [m/s]
  double bubble = 0.0;          // lift over the weight until it lets go
  double bubble_time = 0.0;
  double soaking = 0.0;  // relative growth of the sphere's excess mass over a second
};

struct Track {
  double step = 0.0;  // between values, from the release on
  std::vector<double> gap;
  std::vector<double> fall;    // downward speed
  std::vector<double> hidden;  // upward force of all that is concealed, over the buoyant weight
};

// Motion for `duration` after the release. @param base what the world would be without its secret
Track follow(const World& world, const World& base, double duration);

// Extra resistance of a sphere that moves at right angles to a wall, over Stokes', at gap/radius.
// Brenner 1961, equation 2.19.
double brenner(double gap_over_radius);

}  // namespace blind
