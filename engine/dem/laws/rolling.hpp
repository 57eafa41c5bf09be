// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/dem/laws/hertz_mindlin.hpp"

namespace grouser {

/// Free rolling.
struct NoRolling {
  static constexpr const char* kName = "none";
  static constexpr const char* kSource = "no rolling resistance";
  struct History {};
  static std::vector<StateField> history_fields() { return {}; }

  static NoRolling from_parameters(const Surface&) { return {}; }
  Vec3 evaluate(const ContactPoint&, const ContactForce&, History&, double) const { return {}; }
};

/// Elastic-plastic rolling resistance: a moment grows with the rolling angle at stiffness
/// kr = St R^2 and yields at |M| = mu_r R Fn, R the effective radius.
/// Source: Wensrich and Katterfeld 2012 (model EPSD2 without viscous part); Ai et al. 2011, type C.
/// Neglected: twisting resistance about the normal.
class ElasticPlasticRolling {
 public:
  static constexpr const char* kName = "elastic_plastic";
  static constexpr const char* kSource = "Ai et al. 2011, type C; Wensrich and Katterfeld 2012";

  /// Moment on a of the step before [N m]; zero is a contact that has just begun.
  struct History {
    Vec3 moment;
  };
  static std::vector<StateField> history_fields() { return {{"rolling_moment", "N m", 3}}; }

  static ElasticPlasticRolling from_parameters(const Surface& surface) {
    ElasticPlasticRolling law;
    law.rolling_friction_ = surface.rolling_friction;
    return law;
  }

  /// Moment on a [N m]; renews `history`. @param time_step [s]
  Vec3 evaluate(const ContactPoint& at, const ContactForce& force, History& history,
                double time_step) const {
    const double stiffness = force.stiffness * at.radius * at.radius;
    Vec3 moment = history.moment - dot(history.moment, at.normal) * at.normal;
    moment -= (stiffness * time_step) * at.rolling_rate;
    const double limit = rolling_friction_ * at.radius * force.normal;
    const double length2 = norm2(moment);
    if (length2 > limit * limit) moment *= limit / std::sqrt(length2);
    history.moment = moment;
    return moment;
  }

 private:
  double rolling_friction_ = 0.0;  // [1]
};

}  // namespace grouser
