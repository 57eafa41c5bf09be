// SPDX-License-Identifier: BSD-3-Clause
#include "tests/blind/cases.hpp"

#include <algorithm>
#include <cmath>

namespace blind {
namespace {

using Random = std::mt19937_64;

double uniform(Random& r, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(r);
}
double log_uniform(Random& r, double low, double high) {
  return std::exp(uniform(r, std::log(low), std::log(high)));
}
double normal(Random& r) { return std::normal_distribution<double>()(r); }
double sign(Random& r) { return uniform(r, 0, 1) < 0.5 ? -1.0 : 1.0; }

constexpr double kDiameterError = 0.003;
constexpr double kDensityError = 0.003;
constexpr double kViscosityError = 0.015;

// Terminal speed with Schiller and Naumann's drag or Stokes'.
double terminal_speed(const World& w) {
  const double stokes =
      (w.sphere_density - w.liquid_density) * 9.81 * w.diameter * w.diameter / 18.0 / w.viscosity;
  double v = stokes;
  for (int i = 0; i < 60; ++i) {
    const double re = w.liquid_density * std::abs(v) * w.diameter / w.viscosity;
    v = 0.5 * (v + stokes / (1.0 + w.inertia_drag * 0.15 * std::pow(re, 0.687)));
  }
  return v;
}

bool has(const Case& c, const std::string& name) {
  return std::find(c.secrets.begin(), c.secrets.end(), name) != c.secrets.end();
}

// Values on the run's clock of one channel, sensor applied.
std::vector<double> record(const Run& run, const World& w, const Track& track, bool is_speed,
                           const Sensor& s) {
  std::vector<double> out;
  double lagged = 0.0;
  constexpr int kFine = 20;
  const double h = run.interval / kFine;
  for (int i = 0; i < run.samples; ++i) {
    for (int k = i == 0 ? kFine - 1 : 0; k < kFine; ++k) {
      const double t = (i - 1) * run.interval + (k + 1) * h;
      const double since = t - w.start;
      const double x = std::clamp(since / track.step, 0.0, double(track.gap.size() - 2));
      const auto at = static_cast<std::size_t>(x);
      const std::vector<double>& values = is_speed ? track.fall : track.gap;
      double value = values[at] + (x - double(at)) * (values[at + 1] - values[at]);
      const double phase = 2.0 * M_PI * w.swing_frequency * t + w.swing_phase;
      value += is_speed ? -w.swing * 2.0 * M_PI * w.swing_frequency * std::cos(phase)
                        : w.swing * std::sin(phase);
      lagged =
          s.lag > 0.0 && i > 0 ? lagged + (value - lagged) * (1.0 - std::exp(-h / s.lag)) : value;
    }
    out.push_back(lagged * (1.0 + s.gain) + s.offset + s.creep * i * run.interval);
  }
  return out;
}

double range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

// The liquid and the spheres of a case, as they are and as they are told.
struct Stuff {
  World sphere[2];
};

World draw_world(Case& c, Random& r) {
  World w;
  w.diameter = log_uniform(r, 0.006, 0.02);
  w.liquid_density = uniform(r, 850, 1100);
  w.sphere_density = w.liquid_density * log_uniform(r, 1.15, 4.0);
  w.inertia_drag = c.knows_inertia || has(c, "drag_inertia") ? 1.0 : 0.0;
  w.virtual_mass = c.knows_virtual_mass ? 1.0 : 0.0;
  const double reynolds = c.regime == "creeping" ? log_uniform(r, 0.3, 3.0) : log_uniform(r, 3, 60);
  // Viscosity that gives about this Reynolds number.
  w.viscosity = 0.1;
  for (int i = 0; i < 200; ++i) {
    const double re = w.liquid_density * terminal_speed(w) * w.diameter / w.viscosity;
    w.viscosity *= std::pow(re / reynolds, 0.3);
  }
  w.drop = w.diameter * uniform(r, 4, 9);
  w.width = w.diameter * uniform(r, 5, 12);
  w.restitution = uniform(r, 0.3, 0.9);
  return w;
}

// Puts one secret into a world. `strength` is common to all runs of the case.
void conceal(const std::string& name, double strength, const World& first, const World& told,
             World& w) {
  const double speed = terminal_speed(first);
  const double fall = first.drop / speed;
  if (name == "drag_inertia") w.inertia_drag = strength;
  if (name == "added_mass") w.virtual_mass = strength;
  if (name == "basset") w.memory = strength;
  if (name == "lubrication") w.film = strength;
  if (name == "side_wall") w.side = strength;
  if (name == "ambient_flow") w.current = 0.08 * strength * speed;
  if (name == "release_force") {
    w.grip = 0.5 * strength;
    w.grip_time = 0.15 * fall;
  }
  if (name == "vibration") {
    w.swing = 0.006 * std::abs(strength) * first.drop;
    w.swing_frequency = 9.0 / fall;
    w.swing_phase = 2.0 * strength;
  }
  if (name == "parameter_viscosity") w.viscosity *= 1.0 + 0.15 * strength;
  if (name == "parameter_particle_density" && told.sphere_density == first.sphere_density)
    w.sphere_density += 0.12 * strength * (w.sphere_density - w.liquid_density);
  if (name == "stratified")
    w.stratification = 0.15 * std::abs(strength) * (first.sphere_density - first.liquid_density) /
                       first.liquid_density;
  if (name == "shear_thinning") w.thinning = 0.5 * std::abs(strength);
  if (name == "magnet") w.magnet = 0.4 * strength;
  if (name == "convection") w.roll = 0.3 * strength * speed;
  if (name == "bubble") {
    w.bubble = 0.25 * std::abs(strength);
    w.bubble_time = 0.5 * fall;
  }
  if (name == "soaking") w.soaking = -0.2 * strength / fall;
}

bool is_theory(const std::string& name) {
  return name == "drag_inertia" || name == "added_mass" || name == "basset" ||
         name == "lubrication" || name == "side_wall";
}

Sensor fault(const Case& c, double strength, const Run& run, double range) {
  Sensor s;
  const double duration = run.samples * run.interval;
  if (has(c, "gain")) s.gain = 0.06 * strength;
  if (has(c, "zero")) s.offset = 0.05 * strength * range;
  if (has(c, "lag")) s.lag = std::abs(strength) * 6.0 * run.interval;
  if (has(c, "drift")) s.creep = 0.04 * strength * range / duration;
  return s;
}

void follow_run(Case& c, Run& run) {
  const double duration = run.samples * run.interval;
  const Track real = follow(run.real, run.innocent, duration);
  const Track plain = follow(run.innocent, run.innocent, duration);
  const Sensor none;
  run.clean.clear();
  run.plain.clear();
  for (int channel = 0; channel < (c.has_speed ? 2 : 1); ++channel) {
    const bool is_speed = channel == 1;
    run.plain.push_back(record(run, run.innocent, plain, is_speed, none));
    run.clean.push_back(
        record(run, run.real, real, is_speed, channel == c.sensor_channel ? c.sensor : none));
  }
  // Where the secret acts: its force, or what it changes of a sensor.
  std::vector<double> size;
  const std::size_t shown = c.sensor_channel >= 0 ? std::size_t(c.sensor_channel) : 0;
  const std::vector<double> sound = record(run, run.real, real, shown == 1, none);
  World still = run.real;
  still.swing = 0.0;
  const std::vector<double> calm = record(run, still, real, shown == 1, none);
  const bool is_sensor = c.sensor_channel >= 0;
  for (int i = 0; i < run.samples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double since = (i * run.interval - run.real.start) / real.step;
    const bool is_before = since < 0.0 || since >= double(real.hidden.size());
    size.push_back(is_sensor              ? std::abs(run.clean[shown][at] - sound[at])
                   : run.real.swing > 0.0 ? std::abs(sound[at] - calm[at])
                   : is_before            ? 0.0
                                          : std::abs(real.hidden[static_cast<std::size_t>(since)]));
  }
  const double peak = *std::max_element(size.begin(), size.end());
  run.mask.clear();
  for (const double value : size) run.mask.push_back(peak > 0.0 && value > 0.25 * peak);
}

// Squares of the secret and of what parameters do to the curves, in noise as it is now.
struct Sight {
  std::vector<std::vector<double>> normal;  // of the parameters, and with the secret
  double square = 0.0;                      // of the secret

  // Part of the secret that parameters within their uncertainty cannot imitate, in noise, if that
  // is divided by `factor`.
  double visibility(double factor) const {
    const std::size_t n = normal.size();
    std::vector<std::vector<double>> m = normal;
    for (std::size_t a = 0; a < n; ++a) {
      for (double& value : m[a]) value *= factor * factor;
      m[a][a] += 1.0;  // the parameters' priors
    }
    std::vector<double> right;
    for (std::size_t a = 0; a < n; ++a) right.push_back(m[a][n]);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t row = 0; row < n; ++row) {
        if (row == k) continue;
        const double part = m[row][k] / m[k][k];
        for (std::size_t col = k; col <= n; ++col) m[row][col] -= part * m[k][col];
      }
    double left = square * factor * factor;
    for (std::size_t k = 0; k < n; ++k) left -= m[k][n] / m[k][k] * right[k];
    return std::sqrt(std::max(0.0, left));
  }
};

Sight look(Case& c) {
  std::vector<double> target;
  std::vector<std::vector<double>> columns;
  const auto stack = [&](auto change, std::vector<double>& out) {
    for (Run& run : c.runs) {
      if (run.is_held_out) continue;
      Run moved = run;
      change(moved.innocent, run);
      const double duration = run.samples * run.interval;
      const Track track = follow(moved.innocent, moved.innocent, duration);
      for (std::size_t k = 0; k < run.clean.size(); ++k) {
        const std::vector<double> values = record(run, moved.innocent, track, k == 1, Sensor());
        for (std::size_t i = 0; i < values.size(); ++i)
          out.push_back((values[i] - run.plain[k][i]) / run.noise[k]);
      }
    }
  };
  for (const Run& run : c.runs)
    for (std::size_t k = 0; k < run.clean.size() && !run.is_held_out; ++k)
      for (std::size_t i = 0; i < run.clean[k].size(); ++i)
        target.push_back((run.clean[k][i] - run.plain[k][i]) / run.noise[k]);
  const auto column = [&](auto change) {
    columns.emplace_back();
    stack(change, columns.back());
  };
  column([](World& w, const Run&) { w.viscosity *= 1.0 + kViscosityError; });
  for (const Run& own : c.runs) {
    if (own.is_held_out) continue;
    const auto only = [&](const Run& run) { return run.name == own.name; };
    column([&](World& w, const Run& run) {
      if (only(run)) w.drop *= 1.01;
    });
    column([&](World& w, const Run& run) {
      if (only(run)) w.start += 5.0 * run.interval;
    });
    column([&](World& w, const Run& run) {
      if (only(run)) w.sphere_density *= 1.0 + kDensityError;
    });
    column([&](World& w, const Run& run) {
      if (only(run)) w.diameter *= 1.0 + kDiameterError;
    });
  }
  const std::size_t n = columns.size();
  Sight sight;
  sight.normal.assign(n, std::vector<double>(n + 1, 0.0));
  for (std::size_t i = 0; i < target.size(); ++i) {
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) sight.normal[a][b] += columns[a][i] * columns[b][i];
      sight.normal[a][n] += columns[a][i] * target[i];
    }
    sight.square += target[i] * target[i];
  }
  return sight;
}

void set_noise(Case& c, double share) {
  for (Run& run : c.runs) {
    run.noise.clear();
    for (const std::vector<double>& values : run.clean)
      run.noise.push_back(share * range_of(values));
  }
}

Case draw_once(const std::string& kind, const std::vector<std::string>& secrets, bool is_poor,
               Random& r) {
  Case c;
  c.kind = kind;
  c.secrets = secrets;
  c.regime = uniform(r, 0, 1) < 0.5 ? "creeping" : "inertial";
  c.knows_inertia = !has(c, "drag_inertia") && uniform(r, 0, 1) < 0.7;
  c.knows_virtual_mass = !has(c, "added_mass") && uniform(r, 0, 1) < 0.3;
  c.has_speed = uniform(r, 0, 1) < 0.5;
  c.correlation = uniform(r, 0, 1) < 0.5 ? 0.0 : uniform(r, 0.1, 0.6);
  c.stated = log_uniform(r, 0.5, 2.0);
  const bool is_sensor = has(c, "gain") || has(c, "zero") || has(c, "lag") || has(c, "drift");
  if (is_sensor) c.sensor_channel = c.has_speed && (has(c, "zero") || uniform(r, 0, 1) < 0.5);
  std::vector<double> strengths;
  for (const std::string& name : secrets)
    strengths.push_back(is_theory(name) ? uniform(r, 0.85, 1.15) : sign(r) * uniform(r, 0.5, 1.5));
  if (!secrets.empty() && is_theory(secrets[0])) c.amplitude = strengths[0];

  const World first = draw_world(c, r);
  World second = first;  // another sphere in the same liquid and container
  second.diameter *= uniform(r, 0.5, 0.75);
  second.sphere_density = first.liquid_density * log_uniform(r, 1.15, 4.0);
  World third = first;  // the first sphere in another container, released from elsewhere
  third.width *= uniform(r, 1.6, 2.5);
  third.drop *= uniform(r, 0.6, 1.4);
  World last = second;  // never fitted
  last.width = third.width;
  const std::vector<World> worlds =
      is_poor ? std::vector<World>{first, last} : std::vector<World>{first, second, third, last};
  const double viscosity = 1.0 + kViscosityError * normal(r);
  const int samples = static_cast<int>(uniform(r, 180, 360));
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    Run run;
    run.name = std::string(1, char('A' + k));
    run.is_held_out = k + 1 == worlds.size();
    run.told = worlds[k];
    run.innocent = worlds[k];
    run.innocent.viscosity *= viscosity;
    run.innocent.sphere_density *= 1.0 + kDensityError * normal(r);
    run.innocent.diameter *= 1.0 + kDiameterError * normal(r);
    run.innocent.drop *= 1.0 + 0.01 * normal(r);
    run.samples = samples;
    const double fall = run.told.drop / terminal_speed(run.told);
    run.interval = 1.35 * fall / samples;
    run.innocent.start = run.interval * (20.0 + 5.0 * normal(r));
    run.told.start = 20.0 * run.interval;
    run.real = run.innocent;
    for (std::size_t i = 0; i < secrets.size(); ++i)
      conceal(secrets[i], strengths[i], first, run.told, run.real);
    if (has(c, "drag_inertia")) run.innocent.inertia_drag = 0.0;
    c.runs.push_back(run);
  }
  // One sphere in two runs is one sphere.
  for (Run& run : c.runs)
    for (const Run& other : c.runs)
      if (&other < &run && other.told.diameter == run.told.diameter) {
        for (World Run::*world : {&Run::real, &Run::innocent}) {
          (run.*world).diameter = (other.*world).diameter;
          (run.*world).sphere_density = (other.*world).sphere_density;
        }
        break;
      }
  for (Run& run : c.runs) {
    const double range = c.sensor_channel == 1 ? terminal_speed(first) : first.drop;
    if (is_sensor) c.sensor = fault(c, strengths.back(), c.runs[0], range);
    follow_run(c, run);
  }
  return c;
}

}  // namespace

const std::vector<std::string>& listed_secrets() {
  static const std::vector<std::string> names{"drag_inertia",
                                              "added_mass",
                                              "basset",
                                              "lubrication",
                                              "side_wall",
                                              "ambient_flow",
                                              "release_force",
                                              "vibration",
                                              "gain",
                                              "lag",
                                              "drift",
                                              "zero",
                                              "parameter_viscosity",
                                              "parameter_particle_density"};
  return names;
}

const std::vector<std::string>& unlisted_secrets() {
  static const std::vector<std::string> names{"stratified", "shear_thinning", "magnet",
                                              "convection", "bubble",         "soaking"};
  return names;
}

Case draw_case(const std::string& kind, const std::vector<std::string>& secrets, bool is_poor,
               std::mt19937_64& random) {
  for (int attempt = 0;; ++attempt) {
    Case c = draw_once(kind, secrets, is_poor, random);
    double share = log_uniform(random, 4e-4, 5e-3);
    set_noise(c, share);
    if (kind == "null") return c;
    const double wanted = log_uniform(random, 12.0, 60.0);
    const Sight sight = look(c);
    const double first = share;
    for (int i = 0; i < 6; ++i)
      share = std::clamp(share * sight.visibility(first / share) / wanted, 2e-4, 2e-2);
    set_noise(c, share);
    c.visibility = sight.visibility(first / share);
    if (c.visibility > 10.0 || attempt > 40) return c;
  }
}

}  // namespace blind
