// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/dem/laws/hertz_mindlin.hpp"

namespace grouser {

/// Free rolling.
struct NoRolling {
  static constexpr const char* kName = "none";
  static constexpr const char* kSource = "no rolling resistance";
  template <class Real>
  struct HistoryT {};
  using History = HistoryT<double>;
  static std::vector<StateField> history_fields() { return {}; }

  static NoRolling from_parameters(const Surface&) { return {}; }
  template <class Real>
  Vec3T<Real> evaluate(const ContactPointT<Real>&, const ContactForceT<Real>&, HistoryT<Real>&,
                       double) const {
    return {};
  }
  double energy_of(const History&, const ContactStore&, double) const { return 0.0; }
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
  template <class Real>
  struct HistoryT {
    Vec3T<Real> moment;
  };
  using History = HistoryT<double>;
  static std::vector<StateField> history_fields() { return {{"rolling_moment", "N m", 3}}; }

  static ElasticPlasticRolling from_parameters(const Surface& surface) {
    ElasticPlasticRolling law;
    law.rolling_friction_ = surface.rolling_friction;
    return law;
  }

  /// Moment on a [N m]; renews `history`. @param time_step [s]
  template <class Real>
  Vec3T<Real> evaluate(const ContactPointT<Real>& at, const ContactForceT<Real>& force,
                       HistoryT<Real>& history, double time_step) const {
    using std::sqrt;
    const Real stiffness = force.stiffness * at.radius * at.radius;
    Vec3T<Real> moment = history.moment - dot(history.moment, at.normal) * at.normal;
    moment -= (stiffness * Real(time_step)) * at.rolling_rate;
    const Real limit = Real(rolling_friction_) * at.radius * force.normal;
    const Real length2 = norm2(moment);
    moment *= select(length2 > limit * limit, limit / sqrt(length2), Real(1.0));
    history.moment = moment;
    return moment;
  }

  /// Elastic energy of a contact of effective radius `radius` [m] with this history [J]. Local.
  double energy_of(const History& history, const ContactStore& store, double radius) const {
    const double stiffness = store.stiffness * radius * radius;
    return stiffness > 0.0 ? 0.5 * norm2(history.moment) / stiffness : 0.0;
  }

 private:
  double rolling_friction_ = 0.0;  // [1]
};

}  // namespace grouser
