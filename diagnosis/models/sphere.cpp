// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/models/sphere.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grouser::diagnosis {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRoughness = 1e-3;     // of the radius
constexpr double kLowestBounce = 1e-4;  // of the diameter; below, the sphere stays down

/// Where the sphere is at one time after its release.
struct State {
  double time = 0.0;
  double gap = 0.0;
  double velocity = 0.0;      ///< upward
  double acceleration = 0.0;  ///< upward
  double memory = 0.0;        ///< integral of the history force
};

/// t^(-1/2) as a sum of exponentials, so that the history needs no past:
/// t^(-1/2) = 2/sqrt(pi) integral of exp(x) exp(-t exp(2x)) dx by the trapezoidal rule.
class History {
 public:
  History(double shortest, double longest) {
    constexpr double kStep = 0.5;
    const double low = 0.5 * std::log(0.01 / longest);
    const double high = 0.5 * std::log(100.0 / shortest);
    const double scale = 2.0 / std::sqrt(kPi);
    for (double x = low; x < high + kStep; x += kStep) {
      rate_.push_back(std::exp(2.0 * x));
      weight_.push_back(scale * kStep * std::exp(x));
    }
    // What lies below the lowest rate is as good as constant.
    rate_.insert(rate_.begin(), 0.0);
    weight_.insert(weight_.begin(), scale * std::exp(low - 0.5 * kStep));
    state_.assign(rate_.size(), 0.0);
    decay_.resize(rate_.size());
    gain_.resize(rate_.size());
  }

  /// Prepares a step: memory after it = `rest()` + `slope()` * change of velocity.
  void prepare(double step) {
    if (step != step_)
      for (std::size_t k = 0; k < rate_.size(); ++k) {
        const double x = rate_[k] * step;
        decay_[k] = std::exp(-x);
        gain_[k] = x > 1e-8 ? (1.0 - decay_[k]) / x : 1.0;
      }
    step_ = step;
    rest_ = 0.0;
    slope_ = 0.0;
    for (std::size_t k = 0; k < rate_.size(); ++k) {
      rest_ += weight_[k] * decay_[k] * state_[k];
      slope_ += weight_[k] * gain_[k];
    }
  }
  double rest() const { return rest_; }
  double slope() const { return slope_; }

  void advance(double change) {
    for (std::size_t k = 0; k < rate_.size(); ++k)
      state_[k] = decay_[k] * state_[k] + gain_[k] * change;
  }
  void jump(double change) {
    for (double& state : state_) state += change;
  }

 private:
  std::vector<double> rate_, weight_, state_, decay_, gain_;
  double step_ = -1.0;
  double rest_ = 0.0;
  double slope_ = 0.0;
};

/// The forces of one run.
class Forces {
 public:
  Forces(const Settings& s, const LatentForce& latent) : s_(s), latent_(latent) {
    const double d = s[Setting::kDiameter];
    radius_ = 0.5 * d;
    const double volume = kPi * d * d * d / 6.0;
    fluid_mass_ = volume * s[Setting::kFluidDensity];
    mass_ = volume * s[Setting::kParticleDensity];
    weight_ = (mass_ - fluid_mass_) * s[Setting::kGravity];
    stokes_ = 3.0 * kPi * s[Setting::kViscosity] * d;
    reynolds_ = s[Setting::kFluidDensity] * d / s[Setting::kViscosity];
    history_ = 1.5 * d * d * std::sqrt(kPi * s[Setting::kFluidDensity] * s[Setting::kViscosity]);
    if (s[Setting::kContainerWidth] > 0.0) {
      const double x = std::min(0.8, d / s[Setting::kContainerWidth]);
      wall_ = 1.0 / (1.0 - 2.104 * x + 2.09 * x * x * x - 0.95 * std::pow(x, 5)) - 1.0;
    }
  }

  double inertia() const { return mass_ + s_[Setting::kAddedMass] * 0.5 * fluid_mass_; }
  double fluid_mass() const { return fluid_mass_; }
  double weight() const { return weight_; }
  double history() const { return s_[Setting::kBasset] * history_; }
  double history_at_full_amplitude() const { return history_; }
  double relaxation() const { return inertia() / stokes_; }

  double inertia_factor(double relative) const {
    return 0.15 * std::pow(reynolds_ * std::abs(relative) + 1e-300, 0.687);
  }
  double film_factor(double gap) const {
    const double x = std::max(0.0, gap) / radius_ + kRoughness;
    return (7.0 * x + 2.0) / (6.0 * x * x + 2.0 * x);
  }
  double wall_factor() const { return wall_; }
  double stokes() const { return stokes_; }

  /// Drag over the velocity relative to the fluid; its derivative in that velocity is put into
  /// `slope`.
  double drag(double gap, double relative, double* slope = nullptr) const {
    double factor = 1.0 + s_[Setting::kSideWall] * wall_;
    double growth = factor;
    if (s_[Setting::kDragInertia] != 0.0) {
      const double inertia = s_[Setting::kDragInertia] * inertia_factor(relative);
      growth *= 1.0 + 1.687 * inertia;
      factor *= 1.0 + inertia;
    }
    if (s_[Setting::kLubrication] != 0.0) {
      const double film = s_[Setting::kLubrication] * film_factor(gap);
      factor += film;
      growth += film;
    }
    if (slope != nullptr) *slope = stokes_ * std::max(0.05, growth);
    return stokes_ * std::max(0.05, factor);
  }

  double relative(double velocity) const { return velocity - s_[Setting::kAmbientFlow]; }

  double release_force(double time) const {
    const double fade = std::max(1e-6, s_[Setting::kReleaseForceTime]);
    return s_[Setting::kReleaseForce] * std::exp(-time / fade);
  }

  /// All that does not depend on the motion.
  double given(double time) const {
    const double release = s_[Setting::kReleaseForce] != 0.0 ? release_force(time) : 0.0;
    return weight_ * (release + latent_.at(time) - 1.0);
  }

 private:
  const Settings& s_;
  const LatentForce& latent_;
  double radius_ = 0.0;
  double fluid_mass_ = 0.0;
  double mass_ = 0.0;
  double weight_ = 0.0;
  double stokes_ = 0.0;
  double reynolds_ = 0.0;
  double history_ = 0.0;
  double wall_ = 0.0;
};

/// Solves the motion from the release on.
class Flight {
 public:
  Flight(const Settings& s, const Forces& forces, double duration)
      : s_(s),
        f_(forces),
        is_fine_(forces.history() != 0.0),
        longest_(duration / (is_fine_ ? 450.0 : 300.0)),
        history_(longest_ / 50.0, duration) {
    speed_ = std::abs(f_.weight()) / f_.stokes() / (1.0 + fall_inertia());
    now_.gap = std::max(0.0, s[Setting::kReleaseGap]);
    now_.velocity = -s[Setting::kReleaseSpeed];
    now_.acceleration = (f_.given(0.0) - f_.drag(now_.gap, f_.relative(now_.velocity)) *
                                             f_.relative(now_.velocity)) /
                        f_.inertia();
    path_.push_back(now_);
    while (now_.time < duration && path_.size() < 20000) advance();
  }

  const std::vector<State>& path() const { return path_; }

 private:
  /// Terminal speed is below Stokes'; a rough value does for choosing steps.
  double fall_inertia() const {
    return s_[Setting::kDragInertia] > 0.0
               ? std::sqrt(f_.inertia_factor(std::abs(f_.weight()) / f_.stokes()))
               : 0.0;
  }

  /// Steps in which the velocity changes little, but never far above the last one.
  double next_step() const {
    const double scale = std::abs(now_.velocity) + 0.3 * speed_ + 1e-12;
    // The history is of the first order at jumps.
    const double by_change =
        (is_fine_ ? 0.05 : 0.08) * scale / (std::abs(now_.acceleration) + 1e-12);
    const double by_growth = path_.size() > 1 ? 1.3 * step_ / s_[Setting::kStepFactor] : 1e9;
    const double floor = 1e-3 * longest_;
    return std::max(floor, std::min({longest_, by_change, by_growth})) * s_[Setting::kStepFactor];
  }

  /// Velocity after a step of the theta method; theta = 1/2 (second order) unless the step is
  /// longer than the drag's relaxation, where it would ring.
  double solve(double step) {
    const double m = f_.inertia();
    const double c = f_.history();
    if (c != 0.0) history_.prepare(step);
    const double u0 = f_.relative(now_.velocity);
    const double force0 = -f_.drag(now_.gap, u0) * u0 - c * now_.memory;
    const double given = f_.given(now_.time + 0.5 * step);
    const double x = step * f_.drag(now_.gap, u0) / m;
    const double theta = std::max(0.5, 1.0 - 1.0 / x);
    double v = now_.velocity + step * now_.acceleration;
    double residual_before = 0.0;
    double change = 0.0;
    for (int i = 0; i < 15; ++i) {
      const double gap = now_.gap + 0.5 * step * (now_.velocity + v);
      const double u = f_.relative(v);
      double growth = 0.0;
      const double drag = f_.drag(gap, u, &growth);
      const double memory = c != 0.0 ? history_.rest() + history_.slope() * (v - now_.velocity) : 0;
      const double residual = m * (v - now_.velocity) / step - given - (1.0 - theta) * force0 +
                              theta * (drag * u + c * memory);
      double slope = m / step + theta * (growth + c * history_.slope());
      // The film's own slope is not in `growth`: secant from the third pass on.
      if (i > 1 && residual != residual_before)
        slope = std::max(0.2 * slope, (residual_before - residual) / change);
      residual_before = residual;
      change = residual / slope;
      v -= change;
      if (std::abs(change) < 1e-9 * speed_) break;
    }
    return v;
  }

  void advance() {
    step_ = next_step();
    const double v = solve(step_);
    const double gap = now_.gap + 0.5 * step_ * (now_.velocity + v);
    if (gap < 0.0) {
      touch(v);
      return;
    }
    move(step_, gap, v);
  }

  void move(double step, double gap, double v) {
    if (f_.history() != 0.0) {
      history_.prepare(step);
      history_.advance(v - now_.velocity);
      now_.memory = history_.rest() + history_.slope() * (v - now_.velocity);
    }
    now_.acceleration = (v - now_.velocity) / step;
    now_.time += step;
    now_.gap = gap;
    now_.velocity = v;
    path_.push_back(now_);
  }

  /// The floor is met within the step whose end velocity is `v`.
  void touch(double v) {
    const double a = (v - now_.velocity) / step_;
    const double root =
        std::sqrt(std::max(0.0, now_.velocity * now_.velocity - 2.0 * a * now_.gap));
    const double until =
        std::clamp(2.0 * now_.gap / (root - now_.velocity + 1e-300), 1e-9 * step_, step_);
    move(until, 0.0, now_.velocity + a * until);
    const double rebound = -s_[Setting::kRestitution] * now_.velocity;
    const double height = 0.5 * rebound * rebound * f_.inertia() / std::abs(f_.weight());
    if (height > kLowestBounce * s_[Setting::kDiameter]) {
      if (f_.history() != 0.0) history_.jump(rebound - now_.velocity);
      now_.velocity = rebound;
      now_.acceleration = -std::abs(f_.weight()) / f_.inertia();
      path_.push_back(now_);
      step_ = std::min(step_, 0.02 * 2.0 * rebound * f_.inertia() / std::abs(f_.weight()));
      return;
    }
    now_.velocity = 0.0;
    now_.acceleration = 0.0;
    path_.push_back(now_);
    now_.time = 1e9;
    path_.push_back(now_);
  }

  const Settings& s_;
  const Forces& f_;
  bool is_fine_;
  double longest_;
  double speed_ = 1.0;
  double step_ = 0.0;
  History history_;
  State now_;
  std::vector<State> path_;
};

/// State between two of the path.
State between(const State& a, const State& b, double time) {
  const double step = b.time - a.time;
  State s = b;
  s.time = time;
  if (step <= 0.0) return s;
  const double x = (time - a.time) / step;
  const double y = 1.0 - x;
  s.gap = y * y * (1.0 + 2.0 * x) * a.gap + x * x * (3.0 - 2.0 * x) * b.gap +
          step * x * y * (y * a.velocity - x * b.velocity);
  s.velocity = y * a.velocity + x * b.velocity;
  s.memory = y * a.memory + x * b.memory;
  return s;
}

class SphereModel : public Model {
 public:
  explicit SphereModel(ModelPlan plan) : plan_(std::move(plan)) {}

  std::vector<double> run(const Settings& settings, const LatentForce& latent) const override {
    const Forces forces(settings, latent);
    const std::vector<State> path = fly(settings, forces);
    const std::size_t n = plan_.times.size();
    std::vector<double> out(n * plan_.channels.size());
    for (std::size_t c = 0; c < plan_.channels.size(); ++c) {
      double* const values = out.data() + c * n;
      sample(path, settings, c, values);
      if (settings.sensors.size() > c) apply_sensor(settings.sensors[c], plan_.times, values);
    }
    return out;
  }

  std::vector<double> force_of(Setting term, const Settings& settings) const override {
    const LatentForce none;
    const Forces f(settings, none);
    const std::vector<State> path = fly(settings, f);
    std::vector<double> out;
    std::size_t at = 0;
    for (const double time : plan_.times) {
      const double since = time - settings[Setting::kTrigger];
      const State s = state_at(path, since, at);
      const bool is_moving = since > 0.0 && s.time < 1e8;
      out.push_back(is_moving ? force(term, f, settings, s) / f.weight() : 0.0);
    }
    return out;
  }

 private:
  std::vector<State> fly(const Settings& settings, const Forces& forces) const {
    const double duration =
        std::max(plan_.times.back() - settings[Setting::kTrigger], 0.1 * plan_.times.back()) + 1e-9;
    return Flight(settings, forces, duration).path();
  }

  /// `at` is where the last search ended; times asked for rise.
  static State state_at(const std::vector<State>& path, double since, std::size_t& at) {
    if (since <= 0.0) {
      State rest = path.front();
      rest.time = since;
      rest.velocity = since < 0.0 ? 0.0 : rest.velocity;
      rest.acceleration = 0.0;
      return rest;
    }
    while (at + 2 < path.size() && path[at + 1].time < since) ++at;
    return between(path[at], path[at + 1], since);
  }

  void sample(const std::vector<State>& path, const Settings& settings, std::size_t c,
              double* values) const {
    const double length =
        settings.sensors.size() > c ? settings.sensors[c][index_of(Setting::kFilter)] : 0.0;
    const double lag =
        settings.sensors.size() > c ? settings.sensors[c][index_of(Setting::kLag)] : 0.0;
    if (lag > 0.0) {
      sample_late(path, settings, c, lag, values);
      return;
    }
    std::size_t at = 0;
    for (std::size_t i = 0; i < plan_.times.size(); ++i) {
      const double time = plan_.times[i];
      if (length <= 0.0) {
        values[i] = observe(path, settings, plan_.channels[c], time, at);
        continue;
      }
      constexpr int kPoints = 9;
      at = 0;
      values[i] = 0.0;
      for (int k = 0; k < kPoints; ++k)
        values[i] += observe(path, settings, plan_.channels[c],
                             time + length * ((k + 0.5) / kPoints - 0.5), at) /
                     kPoints;
    }
  }

  /// With a lag, which remembers what was between the samples.
  void sample_late(const std::vector<State>& path, const Settings& settings, std::size_t c,
                   double lag, double* values) const {
    constexpr std::size_t kParts = 8;
    std::vector<double> times{plan_.times[0]};
    for (std::size_t i = 1; i < plan_.times.size(); ++i)
      for (std::size_t k = 1; k <= kParts; ++k)
        times.push_back(plan_.times[i - 1] +
                        (plan_.times[i] - plan_.times[i - 1]) * static_cast<double>(k) / kParts);
    std::vector<double> fine;
    std::size_t at = 0;
    for (const double time : times)
      fine.push_back(observe(path, settings, plan_.channels[c], time, at));
    apply_lag(lag, times, fine.data());
    for (std::size_t i = 0; i < plan_.times.size(); ++i) values[i] = fine[i * kParts];
  }

  static double observe(const std::vector<State>& path, const Settings& settings, Signal signal,
                        double time, std::size_t& at) {
    const State s = state_at(path, time - settings[Setting::kTrigger], at);
    double gap = s.gap;
    double velocity = s.velocity;
    if (settings[Setting::kVibration] != 0.0) {
      const double omega = 2.0 * kPi * settings[Setting::kVibrationFrequency];
      const double angle = omega * time + settings[Setting::kVibrationPhase];
      gap += settings[Setting::kVibration] * std::sin(angle);
      velocity += settings[Setting::kVibration] * omega * std::cos(angle);
    }
    return signal == Signal::kGap ? gap : signal == Signal::kSettlingSpeed ? -velocity : velocity;
  }

  static double force(Setting term, const Forces& f, const Settings& settings, const State& s) {
    const double u = f.relative(s.velocity);
    switch (term) {
      case Setting::kDragInertia:
        return -f.stokes() * f.inertia_factor(u) * u;
      case Setting::kAddedMass:
        return -0.5 * f.fluid_mass() * s.acceleration;
      case Setting::kBasset:
        return -f.history_at_full_amplitude() * s.memory;
      case Setting::kLubrication:
        return -f.stokes() * f.film_factor(s.gap) * u;
      case Setting::kSideWall:
        return -f.stokes() * f.wall_factor() * u;
      case Setting::kAmbientFlow:
        return f.drag(s.gap, u) * settings[Setting::kAmbientFlow];
      case Setting::kReleaseForce:
        return f.weight() * f.release_force(s.time);
      case Setting::kViscosity:
        return -f.drag(s.gap, u) * u;
      case Setting::kParticleDensity:
      case Setting::kFluidDensity:
      case Setting::kDiameter:
        return -f.weight();
      default:
        return 0.0;
    }
  }

  ModelPlan plan_;
};

}  // namespace

std::unique_ptr<Model> make_sphere_model(ModelPlan plan) {
  return std::make_unique<SphereModel>(std::move(plan));
}

}  // namespace grouser::diagnosis
