// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/laws/hertz_mindlin.hpp"

#include <algorithm>
#include <cmath>

#include "base/check.hpp"

namespace grouser {
namespace {

// Restitution of the cut law in units in which mass, 4/3 E* sqrt(R) and impact speed are 1:
// x'' = -max(0, x^(3/2) + sqrt(5) beta x^(1/4) x'). Starts a little inside the contact, where the
// motion is still free, because x^(1/4) is not smooth at 0.
double scaled_restitution(double beta) {
  const double damping = std::sqrt(5.0) * beta;
  const auto acceleration = [damping](double x, double v) {
    if (x <= 0.0) return 0.0;
    const double force = x * std::sqrt(x) + damping * std::sqrt(std::sqrt(x)) * v;
    return force > 0.0 ? -force : 0.0;
  };
  double x = 0.0;
  double v = 1.0;
  double step = 1e-7;
  while (v > 0.0 || acceleration(x, v) < 0.0) {
    const double k1 = acceleration(x, v);
    const double k2 = acceleration(x + 0.5 * step * v, v + 0.5 * step * k1);
    const double k3 = acceleration(x + 0.5 * step * (v + 0.5 * step * k1), v + 0.5 * step * k2);
    const double k4 = acceleration(x + step * (v + 0.5 * step * k2), v + step * k3);
    x += step * (v + step * (k1 + k2 + k3) / 6.0);
    v += step * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    step = std::min(2e-4, 1.05 * step);
    if (x <= 0.0) break;
  }
  return -v;
}

}  // namespace

double HertzMindlin::damping_for(double restitution) {
  GROUSER_CHECK(restitution > 0.0 && restitution <= 1.0);
  if (restitution == 1.0) return 0.0;
  double low = 0.0;
  double high = 1.0;
  while (scaled_restitution(high) > restitution) high *= 2.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (scaled_restitution(middle) > restitution ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

HertzMindlin HertzMindlin::from_parameters(const Solid& a, const Solid& b, const Surface& surface) {
  const auto compliance = [](const Solid& s) {
    return (1.0 - s.poisson_ratio * s.poisson_ratio) / s.young_modulus;
  };
  const auto shear_compliance = [](const Solid& s) {
    const double shear = s.young_modulus / (2.0 * (1.0 + s.poisson_ratio));
    return (2.0 - s.poisson_ratio) / shear;
  };
  HertzMindlin law;
  law.young_ = 1.0 / (compliance(a) + compliance(b));
  law.shear_ = 1.0 / (shear_compliance(a) + shear_compliance(b));
  law.damping_ = 2.0 * std::sqrt(5.0 / 6.0) * damping_for(surface.restitution);
  law.friction_ = surface.friction;
  law.tangential_share_ = 2.0 * std::sqrt(law.shear_ / law.young_);
  return law;
}

}  // namespace grouser
