// SPDX-License-Identifier: BSD-3-Clause
#include "tests/blind/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace blind {
namespace {

constexpr double kG = 9.81;
constexpr int kSteps = 3000;

// Brenner's sum, tabled over the logarithm of the gap, because it is asked a million times.
class BrennerTable {
 public:
  BrennerTable() {
    for (std::size_t i = 0; i < kCount; ++i)
      table_[i] = brenner(std::exp(kLow + (kHigh - kLow) * double(i) / double(kCount - 1)));
  }
  double at(double gap) const {
    const double x = (std::log(gap) - kLow) / (kHigh - kLow) * double(kCount - 1);
    if (x >= double(kCount - 1)) return 9.0 / 8.0 / (1.0 + gap);
    const auto i = static_cast<std::size_t>(std::max(0.0, x));
    const double part = std::max(0.0, x) - double(i);
    return table_[i] + part * (table_[i + 1] - table_[i]);
  }

 private:
  static constexpr std::size_t kCount = 600;
  static constexpr double kLow = -7.0;
  static constexpr double kHigh = 3.5;
  std::array<double, kCount> table_{};
};

double haberman(double x) {
  const double x5 = std::pow(x, 5);
  return (1.0 - 0.75857 * x5) /
         (1.0 - 2.1050 * x + 2.0865 * x * x * x - 1.7068 * x5 + 0.72603 * x5 * x);
}

struct Parts {
  double resistance = 0.0;  // force over -(velocity - flow)
  double flow = 0.0;
  double push = 0.0;  // upward, weight included
  double mass = 0.0;
};

class Laws {
 public:
  Laws(const World& w) : w_(w) {
    volume_ = 4.0 / 3.0 * M_PI * std::pow(0.5 * w.diameter, 3);
    excess_ = volume_ * (w.sphere_density - w.liquid_density) * kG;
  }
  double weight() const { return excess_; }
  double liquid() const { return volume_ * w_.liquid_density; }

  Parts at(double t, double gap, double up) const {
    static const BrennerTable table;
    Parts p;
    const double a = 0.5 * w_.diameter;
    p.flow = w_.current + w_.roll * std::exp(-std::pow((gap / w_.drop - 0.5) / 0.15, 2));
    const double relative = std::abs(up - p.flow);
    double mu = w_.viscosity;
    if (w_.thinning > 0.0) {
      const double creeping = excess_ / (6.0 * M_PI * w_.viscosity * a);
      mu *= 1.0 - w_.thinning * relative / (relative + creeping);
    }
    const double re = w_.liquid_density * relative * w_.diameter / mu;
    double factor = 1.0;
    if (w_.side > 0.0) factor += w_.side * (haberman(w_.diameter / w_.width) - 1.0);
    factor *= 1.0 + w_.inertia_drag * 0.15 * std::pow(re, 0.687);
    if (w_.film > 0.0) factor += w_.film * table.at(std::max(gap, 0.0) / a + 1e-3);
    p.resistance = 6.0 * M_PI * mu * a * factor;
    double lift = -1.0;
    lift += w_.grip * std::exp(-t / w_.grip_time);
    lift -= w_.stratification == 0.0
                ? 0.0
                : -w_.stratification * (1.0 - gap / w_.drop) * w_.liquid_density /
                      (w_.sphere_density - w_.liquid_density);
    lift += w_.magnet * std::exp(-std::pow((gap / w_.drop - 0.5) / 0.12, 2));
    if (t < w_.bubble_time) lift += w_.bubble;
    lift -= w_.soaking * t;
    p.push = excess_ * lift;
    p.mass = volume_ * (w_.sphere_density + 0.5 * w_.virtual_mass * w_.liquid_density);
    return p;
  }

  double history() const {
    return w_.memory * 6.0 * std::pow(0.5 * w_.diameter, 2) *
           std::sqrt(M_PI * w_.liquid_density * w_.viscosity);
  }

 private:
  const World& w_;
  double volume_ = 0.0;
  double excess_ = 0.0;
};

// Exponential midpoint steps for the drag, product quadrature over the whole past for the history.
class Motion {
 public:
  Motion(const World& w, double duration) : w_(w), laws_(w), step_(duration / kSteps) {
    for (int k = 0; k <= kSteps; ++k)
      kernel_.push_back(2.0 * (std::sqrt(k + 1.0) - std::sqrt(double(k))) * std::sqrt(step_));
    gap_ = w.drop;
  }

  void run(Track& track) {
    for (int i = 0; i < kSteps; ++i) {
      track.gap.push_back(std::max(0.0, gap_));
      track.fall.push_back(-up_);
      up_track_.push_back(up_);
      advance(i);
    }
  }
  const std::vector<double>& accelerations() const { return acceleration_; }
  const std::vector<double>& histories() const { return history_; }
  const Laws& laws() const { return laws_; }

 private:
  double past(int now) const {
    if (laws_.history() == 0.0) return 0.0;
    double sum = 0.0;
    for (int j = 0; j < now; ++j)
      sum +=
          acceleration_[static_cast<std::size_t>(j)] * kernel_[static_cast<std::size_t>(now - j)];
    for (const auto& [at, change] : kicks_) sum += change / std::sqrt((now - at + 0.5) * step_);
    return sum;
  }

  void advance(int now) {
    history_.push_back(0.0);
    acceleration_.push_back(0.0);
    if (is_down_) return;
    const double t = now * step_;
    const double c = laws_.history();
    const double before = past(now);
    const double heavy = c * kernel_[0];  // the step's own share acts like mass
    double v = up_;
    double gap = gap_;
    for (int pass = 0; pass < 4; ++pass) {
      const Parts p = laws_.at(t + 0.5 * step_, std::max(0.0, 0.5 * (gap_ + gap)), 0.5 * (up_ + v));
      const double mass = p.mass + heavy;
      const double goal = p.flow + (p.push - c * before) / p.resistance;
      const double fade = std::exp(-p.resistance * step_ / mass);
      v = goal + (up_ - goal) * fade;
      const double decay = mass / p.resistance;
      gap = gap_ + goal * step_ + (up_ - goal) * decay * (1.0 - fade);
    }
    acceleration_.back() = (v - up_) / step_;
    history_.back() = before + kernel_[0] * acceleration_.back();
    if (gap <= 0.0) {
      hit(now, v);
      return;
    }
    gap_ = gap;
    up_ = v;
  }

  void hit(int now, double v) {
    const double part = std::min(1.0, gap_ / std::max(1e-12, -0.5 * (up_ + v) * step_));
    const double before = up_ + part * (v - up_);
    const double after = -w_.restitution * before;
    const Parts p = laws_.at(now * step_, 0.0, after);
    const double pull = (p.push - p.resistance * (after - p.flow) -
                         (laws_.history() > 0.0 ? laws_.history() * past(now) : 0.0)) /
                        p.mass;
    // A flight of a few steps is no flight: it lies.
    if (0.5 * after * after / kG < 2e-5 * w_.diameter || 2.0 * after < -6.0 * pull * step_) {
      is_down_ = true;
      gap_ = 0.0;
      up_ = 0.0;
      return;
    }
    kicks_.emplace_back(now, after - before);
    acceleration_.back() = (before - up_) / step_;
    const double rest = (1.0 - part) * step_;
    gap_ = std::max(0.0, after * rest + 0.5 * pull * rest * rest);
    up_ = after + pull * rest;
  }

  const World& w_;
  Laws laws_;
  double step_;
  std::vector<double> kernel_;
  std::vector<double> acceleration_, history_, up_track_;
  std::vector<std::pair<int, double>> kicks_;
  double gap_ = 0.0;
  double up_ = 0.0;
  bool is_down_ = false;
};

}  // namespace

double brenner(double gap) {
  const double alpha = std::acosh(1.0 + gap);
  double sum = 0.0;
  for (int n = 1; n < 4000; ++n) {
    const double x = (2.0 * n + 1.0) * alpha;
    if (x > 600.0) break;
    const double top = 2.0 * std::sinh(x) + (2.0 * n + 1.0) * std::sinh(2.0 * alpha);
    const double low = 4.0 * std::pow(std::sinh((n + 0.5) * alpha), 2) -
                       std::pow((2.0 * n + 1.0) * std::sinh(alpha), 2);
    const double term = n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0)) * (top / low - 1.0);
    sum += term;
    if (term < 1e-10 * sum) break;
  }
  return 4.0 / 3.0 * std::sinh(alpha) * sum - 1.0;
}

Track follow(const World& world, const World& base, double duration) {
  Track track;
  track.step = duration / kSteps;
  Motion motion(world, duration);
  motion.run(track);
  const Laws plain(base);
  for (std::size_t i = 0; i < track.gap.size(); ++i) {
    const double t = double(i) * track.step;
    const Parts with = motion.laws().at(t, track.gap[i], -track.fall[i]);
    const Parts without = plain.at(t, track.gap[i], -track.fall[i]);
    double force = with.push - without.push - with.resistance * (-track.fall[i] - with.flow) +
                   without.resistance * (-track.fall[i] - without.flow) -
                   (with.mass - without.mass) * motion.accelerations()[i] -
                   motion.laws().history() * motion.histories()[i];
    if (track.gap[i] <= 0.0) force = 0.0;
    track.hidden.push_back(force / plain.weight());
  }
  return track;
}

}  // namespace blind
