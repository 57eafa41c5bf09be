// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "engine/core/pack.hpp"
#include "engine/core/state_io.hpp"

namespace grouser {

/// Elastic constants of a solid. Young's modulus [Pa], Poisson's ratio [1].
struct Solid {
  double young_modulus = 0.0;
  double poisson_ratio = 0.0;
};

/// Surface of a pair of solids: normal restitution, Coulomb friction and rolling resistance
/// coefficients [1].
struct Surface {
  double restitution = 1.0;
  double friction = 0.0;
  double rolling_friction = 0.0;
};

/// The moving state of one contact, as every law gets it. The normal points from body b to body a;
/// velocities are those of a relative to b.
/// @tparam Real  double, or Pack for four contacts; laws are written for both and give the same
/// bits
template <class Real>
struct ContactPointT {
  Real overlap{};             ///< [m], > 0
  Real radius{};              ///< effective radius 1/(1/Ra + 1/Rb) [m]
  Real mass{};                ///< effective mass 1/(1/ma + 1/mb) [kg]
  Vec3T<Real> normal;         ///< unit vector
  Real normal_velocity{};     ///< rate of separation [m s-1], negative when approaching
  Vec3T<Real> slip_velocity;  ///< of a's surface over b's in the contact plane [m s-1]
  Vec3T<Real> rolling_rate;   ///< spin of a relative to b, twist about the normal removed [rad s-1]
};
using ContactPoint = ContactPointT<double>;

/// What a contact does to a.
template <class Real>
struct ContactForceT {
  Real normal{};           ///< along the normal [N], never negative: dry grains do not pull
  Vec3T<Real> tangential;  ///< [N]
  Real stiffness{};        ///< tangential stiffness of this moment [N m-1], for rolling laws
};
using ContactForce = ContactForceT<double>;

/// What a contact holds, told by its history alone.
struct ContactStore {
  double overlap = 0.0;    ///< [m]
  double energy = 0.0;     ///< elastic, normal and tangential [J]
  double stiffness = 0.0;  ///< tangential [N m-1]
};

/// Hertz normal force, Mindlin tangential spring with Coulomb limit, viscous damping in both.
///
/// Normal: F = 4/3 E* sqrt(R) d^(3/2) - 2 sqrt(5/6) beta sqrt(Sn m) v, Sn = 2 E* sqrt(R d)
/// (Tsuji, Tanaka, Ishida 1992), cut at zero so that damping never pulls. beta is chosen so that
/// this cut law returns the wanted restitution exactly, at any impact speed (the law has no speed
/// scale; see damping_for).
/// Tangential: dF = -St du, St = 8 G* sqrt(R d) (Mindlin 1949); when the contact unloads, the
/// elastic force shrinks with St, which keeps a closed loop from creating energy (Thornton,
/// Cummins, Cleary 2013). While it sticks, damping with the same beta is added; the sum never
/// exceeds friction times the normal force.
/// Neglected: partial slip of the Mindlin-Deresiewicz theory, twist about the normal, spin of the
/// pair about its normal (the elastic force is projected onto the new contact plane instead).
class HertzMindlin {
 public:
  static constexpr const char* kName = "hertz_mindlin";
  static constexpr const char* kSource =
      "Hertz 1882; Mindlin 1949; Tsuji, Tanaka, Ishida 1992; Thornton, Cummins, Cleary 2013";

  /// What one contact remembers. All zero is a contact that has just begun.
  template <class Real>
  struct HistoryT {
    Vec3T<Real> spring;  ///< elastic part of the tangential force on a [N]
    Real patch{};        ///< sqrt(R d) of the step before [m]; 0 = no contact
  };
  using History = HistoryT<double>;
  static std::vector<StateField> history_fields() {
    return {{"spring", "N", 3}, {"patch", "m", 1}};
  }

  HertzMindlin() = default;
  static HertzMindlin from_parameters(const Solid& a, const Solid& b, const Surface& surface);

  /// Force on a; renews `history`. @param time_step [s]
  template <class Real>
  ContactForceT<Real> evaluate(const ContactPointT<Real>& at, HistoryT<Real>& history,
                               double time_step) const;

  /// What a contact of effective radius `radius` [m] with this history holds. The energy is
  /// 8/15 E* sqrt(R) d^(5/2) + Fe^2/(2 St). Local.
  ContactStore store_of(const History& history, double radius) const {
    const double patch2 = history.patch * history.patch;
    ContactStore out;
    out.overlap = patch2 / radius;
    out.stiffness = 8.0 * shear_ * history.patch;
    if (history.patch > 0.0)
      out.energy = 8.0 / 15.0 * young_ * patch2 * patch2 * history.patch / (radius * radius) +
                   0.5 * norm2(history.spring) / out.stiffness;
    return out;
  }

  /// Damping ratio beta for which the cut law returns `restitution` (0.01 to 1). Integrates the
  /// collision of two bodies in scaled form; relative error of the restitution below 1e-4. Local.
  static double damping_for(double restitution);

 private:
  double young_ = 0.0;     // E* [Pa]
  double shear_ = 0.0;     // G* [Pa]
  double damping_ = 0.0;   // 2 sqrt(5/6) beta [1]
  double friction_ = 0.0;  // [1]
  // sqrt(St/Sn), which is the same in every contact: 2 sqrt(G*/E*).
  double tangential_share_ = 0.0;
};

template <class Real>
[[gnu::always_inline]] inline ContactForceT<Real> HertzMindlin::evaluate(
    const ContactPointT<Real>& at, HistoryT<Real>& history, double time_step) const {
  using std::sqrt;
  const Real patch = sqrt(at.radius * at.overlap);
  const Real normal_stiffness = Real(2.0 * young_) * patch;
  const Real damping = Real(damping_) * sqrt(normal_stiffness * at.mass);
  ContactForceT<Real> out;
  out.normal = Real(2.0 / 3.0) * normal_stiffness * at.overlap - damping * at.normal_velocity;
  out.normal = select(out.normal > Real(0.0), out.normal, Real(0.0));
  out.stiffness = Real(8.0 * shear_) * patch;

  // Turn the old spring into the new contact plane, keeping its length while the turn is small;
  // what is left of a spring that stood almost upright on the plane tells no direction. For
  // sqrt(1 + x) of x = lost2 / left2 stands (4 + 3 x) / (4 + x), which is never larger and the same
  // to rounding for turns below 0.004 a step: one division serves for this and for the shrinking of
  // a contact that unloads.
  const Real upright = dot(history.spring, at.normal);
  Vec3T<Real> spring = history.spring - upright * at.normal;
  const Real lost2 = upright * upright;
  const Real left2 = norm2(spring);
  const Real before = Real(4.0) * left2 + lost2;
  const Real after = select(Real(3.0) * left2 > lost2, before + (lost2 + lost2), before);
  const Real held = before * history.patch;
  const Real kept = after * select(patch < history.patch, patch, history.patch);
  spring *= select(held > Real(0.0), kept / held, Real(1.0));
  spring -= (out.stiffness * Real(time_step)) * at.slip_velocity;

  // Without branches: contacts that slide follow no pattern a processor could foresee.
  const Real limit = Real(friction_) * out.normal;
  const Real limit2 = limit * limit;
  const Real length2 = norm2(spring);
  const auto slides = length2 > limit2;
  const Vec3T<Real> damped = spring - (Real(tangential_share_) * damping) * at.slip_velocity;
  out.tangential = select(slides, spring, damped);
  const Real total2 = select(slides, length2, norm2(damped));
  const Real cut = select(total2 > limit2, limit / sqrt(total2), Real(1.0));
  out.tangential *= cut;
  spring = select(slides, out.tangential, spring);
  history.spring = spring;
  history.patch = patch;
  return out;
}

}  // namespace grouser
