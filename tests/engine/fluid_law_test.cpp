// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "base/fluid_case.hpp"
#include "engine/coupling/history_modes.hpp"
#include "engine/coupling/laws/table.hpp"

namespace grouser {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Fluid kWater{1000.0, 1e-3};

template <class List>
struct TypesOf;
template <class... Law>
struct TypesOf<std::variant<Law...>> {
  using Types = ::testing::Types<Law...>;
};

// The standard drag curve of a sphere over Stokes' drag (Clift, Grace, Weber 1978, table 5.2).
double standard_drag(double re) {
  const double w = std::log10(re);
  double cd = 0.0;
  if (re < 0.01) return 1.0 + 3.0 / 16.0 * re;
  if (re <= 20.0) return 1.0 + 0.1315 * std::pow(re, 0.82 - 0.05 * w);
  if (re <= 260.0) return 1.0 + 0.1935 * std::pow(re, 0.6305);
  if (re <= 1500.0) {
    cd = std::pow(10.0, 1.6435 - 1.1242 * w + 0.1558 * w * w);
  } else if (re <= 1.2e4) {
    cd = std::pow(10.0, -2.4571 + 2.5558 * w - 0.9295 * w * w + 0.1049 * w * w * w);
  } else if (re <= 4.4e4) {
    cd = std::pow(10.0, -1.9181 + 0.6370 * w - 0.0636 * w * w);
  } else {
    cd = std::pow(10.0, -4.3390 + 1.5809 * w - 0.1546 * w * w);
  }
  return cd * re / 24.0;
}

TEST(StandardDrag, IsWhatSpheresWereMeasuredToFeel) {
  // Reynolds number and drag coefficient, smoothed experiments (Lapple and Shepherd 1940 and later
  // compilations scatter by 5 %).
  for (const auto& [re, cd] : {std::pair{57.54, 1.479},
                               {144.5, 0.9204},
                               {512.9, 0.5623},
                               {1000.0, 0.4786},
                               {3162.0, 0.4074},
                               {8375.0, 0.3981},
                               {26480.0, 0.4571}})
    EXPECT_NEAR(standard_drag(re) * 24.0 / re, cd, 0.05 * cd) << re;
}

template <class Law>
class EveryDragLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryDragLaw, TypesOf<DragLaw>::Types);

TYPED_TEST(EveryDragLaw, SaysWhereItComesFrom) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  EXPECT_EQ(law_named<DragLaw>(TypeParam::kName).index(), DragLaw(TypeParam()).index());
}

TYPED_TEST(EveryDragLaw, FollowsTheStandardCurveWithinItsBands) {
  ASSERT_GE(TypeParam::kBands.size(), 1u);
  for (const DragBand& band : TypeParam::kBands) {
    EXPECT_LT(band.tolerance, 0.35);  // a law that is worse is none
    for (double re = std::max(band.low, 1e-4) * 1.001; re <= band.high; re *= 1.07)
      EXPECT_NEAR(TypeParam::factor(re, 1.0) / standard_drag(re), 1.0, band.tolerance) << re;
  }
}

TYPED_TEST(EveryDragLaw, IsStokesDragInTheCreepingLimit) {
  // DallaValle's is 4 % below.
  EXPECT_NEAR(TypeParam::factor(0.0, 1.0), 1.0, 0.041);
  EXPECT_NEAR(TypeParam::factor(1e-8, 1.0), TypeParam::factor(0.0, 1.0), 1e-3);
}

TYPED_TEST(EveryDragLaw, GrowsWithSpeedAndWithTheCrowd) {
  for (const double voids : {0.35, 0.45, 0.6, 0.79, 0.81, 0.95, 1.0})
    // Those from arrays are made for Reynolds numbers of up to 1000.
    for (double re = 1e-3; re < 1000.0; re *= 1.3) {
      const double here = TypeParam::factor(re, voids);
      EXPECT_TRUE(std::isfinite(here));
      EXPECT_GE(TypeParam::factor(1.1 * re, voids) * 1.1 * re, here * re) << re << " " << voids;
      if (TypeParam::kUsesVoidFraction) {
        EXPECT_GE(TypeParam::factor(re, voids - 0.02), here * (1.0 - 1e-12)) << re << " " << voids;
      } else {
        EXPECT_EQ(TypeParam::factor(re, 0.4), here);
      }
    }
}

TYPED_TEST(EveryDragLaw, OfACrowdResistsLikeAPackedBed) {
  // Ergun 1952, measured on beds of void fraction 0.36 to 0.48; laws from suspensions and from
  // computed arrays differ from it by up to a third and more (Beetstra et al. 2007, figure 7).
  if (!TypeParam::kUsesVoidFraction) return;
  for (const double voids : {0.38, 0.42, 0.46})
    for (double re = 1.0; re <= 1000.0; re *= 2.0) {
      const double ratio = TypeParam::factor(re, voids) / ErgunDrag::factor(re, voids);
      EXPECT_GT(ratio, 0.5) << voids << " " << re;
      EXPECT_LT(ratio, 1.6) << voids << " " << re;
    }
}

// Drag on a grain of a bed from the measured exponent of hindered settling, U = U_t n^e.
double richardson_zaki(double voids, double exponent) {
  // Balance of a settling suspension: factor(n) |u - v| = n factor(1) U_t, |u - v| = U / n.
  return voids * voids / std::pow(voids, exponent);
}

TEST(DragLaws, OfSuspensionsSettleAsRichardsonAndZakiMeasured) {
  // Creeping flow: exponent 4.65 (Richardson and Zaki 1954), 4.7 to 4.8 in later work.
  for (const double voids : {0.6, 0.7, 0.8, 0.9}) {
    EXPECT_NEAR(WenYuDrag::factor(1e-6, voids) / richardson_zaki(voids, 4.65), 1.0, 1e-3);
    EXPECT_NEAR(DiFeliceBrownLawlerDrag::factor(1e-6, voids) / richardson_zaki(voids, 4.7), 1.0,
                1e-2);
  }
}

TEST(DragLaws, OfFixedArraysMeetTheExactDiluteLimit) {
  // Kim and Russel 1985: F = 1 + 3/sqrt2 s^(1/2) + 135/64 s ln s + 16.456 s, total force over
  // Stokes' at the flux. The fit's own next term is of order s^(3/2).
  for (const double solid : {0.001, 0.005, 0.01}) {
    const double exact = 1.0 + 3.0 / std::sqrt(2.0) * std::sqrt(solid) +
                         135.0 / 64.0 * solid * std::log(solid) + 16.456 * solid;
    const double voids = 1.0 - solid;
    EXPECT_NEAR(KochHillDrag::factor(0.0, voids) / (voids * voids), exact, 0.012) << solid;
  }
}

TEST(DragLaws, OfPackedArraysMeetCarmanAndKozeny) {
  // 180 instead of Ergun's 150: measured in creeping flow within 10 % (Happel and Brenner 1965).
  for (const double voids : {0.4, 0.5}) {
    const double carman = 10.0 * (1.0 - voids) / voids;
    EXPECT_NEAR(KochHillDrag::factor(0.0, voids) / carman, 1.0, 0.1);
    EXPECT_NEAR(BeetstraDrag::factor(0.0, voids) / carman, 1.0, 0.1);
  }
}

TEST(DragLaws, MeetNewtonsLimit) {
  // Drag coefficients of 0.44 and 0.63^2; Brown and Lawler's own is 0.407 + 3.6 Re^-0.319.
  EXPECT_NEAR(SchillerNaumannDrag::factor(1e5, 1.0) * 24.0 / 1e5, 0.44, 1e-12);
  EXPECT_NEAR(DallaValleDrag::factor(1e5, 1.0) * 24.0 / 1e5, 0.4163, 1e-4);
  EXPECT_NEAR(BrownLawlerDrag::factor(1e5, 1.0) * 24.0 / 1e5,
              0.407 / 1.0871 + 3.6 * std::pow(1e5, -0.319), 1e-3);
}

// Names of a list's laws.
template <class... Law>
std::set<std::string> names_of(const std::variant<Law...>&) {
  return {Law::kName...};
}

// Words that the case takes for the law of a term: what it says when it gets another.
std::set<std::string> words_of(const std::string& term) {
  std::vector<Problem> problems;
  FluidCase fluid;
  read_fields(
      parse_yaml("density: 1 kg m-3\nviscosity: 1 Pa s\n" + term + ": {law: nonesuch}\n", "x"),
      [&](FieldVisitor& visitor) { describe(visitor, fluid); }, problems);
  if (problems.size() != 1) return {};
  std::string text = problems[0].hint;
  text = text.substr(text.find("allowed: ") + 9) + ", ";
  std::set<std::string> words;
  for (std::size_t at = 0; at < text.size(); at = text.find(", ", at) + 2)
    words.insert(text.substr(at, text.find(", ", at) - at));
  return words;
}

TEST(FluidCase, NamesTheLawsOfTheListsAndNoOthers) {
  EXPECT_EQ(words_of("drag"), names_of(DragLaw()));
  EXPECT_EQ(words_of("added_mass"), names_of(AddedMassLaw()));
  EXPECT_EQ(words_of("history"), names_of(HistoryLaw()));
  EXPECT_EQ(words_of("shear_lift"), names_of(ShearLiftLaw()));
  EXPECT_EQ(words_of("spin_lift"), names_of(SpinLiftLaw()));
  EXPECT_EQ(words_of("spin_drag"), names_of(SpinDragLaw()));
  EXPECT_EQ(words_of("lubrication"), names_of(LubricationLaw()));
  EXPECT_EQ(words_of("wall"), names_of(WallLaw()));
}

template <class Law>
class EveryWallLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryWallLaw, TypesOf<WallLaw>::Types);

TYPED_TEST(EveryWallLaw, SlowsTheSphereMoreTheNarrowerTheContainer) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  for (const double re : {0.0, 1.0, 100.0}) {
    EXPECT_EQ(TypeParam::factor(0.0, re), 1.0);
    double wider = 1.0;
    for (double ratio = 0.01; ratio < TypeParam::kLargestRatio; ratio += 0.01) {
      const double here = TypeParam::factor(ratio, re);
      EXPECT_GT(here, 0.0);
      EXPECT_LE(here, wider);
      wider = here;
    }
  }
}

TYPED_TEST(EveryWallLaw, MeetsTheExactCreepingFactors) {
  // Haberman and Sayre 1958, exact drag factors 1.263, 1.680, 2.371, 3.596, 5.970 at ratios of 0.1
  // to 0.5; the measured law is within 10 % of them.
  if (std::string(TypeParam::kName) == "none") return;
  for (const auto& [ratio, drag] :
       {std::pair{0.1, 1.263}, {0.2, 1.680}, {0.3, 2.371}, {0.4, 3.596}, {0.5, 5.970}})
    EXPECT_NEAR(1.0 / TypeParam::factor(ratio, 0.0) / drag, 1.0, 0.1) << ratio;
}

// Brenner 1961: drag of a sphere towards a plane wall over Stokes', gap over radius `gap`.
double brenner_series(double gap) {
  const double a = std::acosh(1.0 + gap);
  double sum = 0.0;
  for (int n = 1; n < 4000; ++n) {
    const double m = 2.0 * n + 1.0;
    if (m * a > 600.0) break;
    const double top = 2.0 * std::sinh(m * a) + m * std::sinh(2.0 * a);
    const double s = std::sinh(0.5 * m * a);
    const double t = m * std::sinh(a);
    sum +=
        n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0)) * (top / (4.0 * s * s - t * t) - 1.0);
  }
  return 4.0 / 3.0 * std::sinh(a) * sum;
}

template <class Law>
class EveryLubricationLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryLubricationLaw, TypesOf<LubricationLaw>::Types);

TYPED_TEST(EveryLubricationLaw, MeetsTheThinFilm) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  EXPECT_NEAR(TypeParam::excess(1e-4) * 1e-4, 1.0, 1e-3);
  // The next term, 1/5 ln(1/gap) - 0.03, is under 2 % of the whole below a gap of 0.01.
  EXPECT_NEAR((1.0 + TypeParam::excess(0.01)) / brenner_series(0.01), 1.0, 0.02);
}

TYPED_TEST(EveryLubricationLaw, OfTwoEqualSpheresIsAQuarterOfThatTowardsAWall) {
  // Source: Kim, Karrila 1991: 6 pi mu a^2 b^2/(a + b)^2 / gap, so 6 pi mu a^2/(4 gap) for equal
  // ones; the cutoff takes 2 % of it at a gap of 0.01 a.
  const double a = 1e-3;
  for (const double gap : {1e-6, 1e-5}) {
    const double wanted = 6.0 * kPi * 1e-3 * a * a / (4.0 * gap);
    EXPECT_NEAR(lubrication_coefficient<TypeParam>(kWater, 0.5 * a, gap, 1e-4, 1.0) / wanted, 1.0,
                0.05)
        << gap;
  }
}

TYPED_TEST(EveryLubricationLaw, BeginsWithoutAStepAndEndsAtTheRoughness) {
  const auto at = [](double gap) {
    return lubrication_coefficient<TypeParam>(kWater, 1e-3, gap, 1e-3, 0.5);
  };
  EXPECT_EQ(at(0.5e-3), 0.0);
  EXPECT_LT(at(0.499e-3), 0.01 * at(0.1e-3));
  EXPECT_EQ(at(1e-7), at(1e-6));
  EXPECT_EQ(at(-1e-5), at(1e-6));
  // 6 pi mu R^2/h, its cutoff of 2 and at most 20 % beyond the leading term aside.
  EXPECT_NEAR(at(1e-5) / (6.0 * kPi * 1e-3 * 1e-6 / 1e-5), 1.0, 0.03);
}

TEST(BrennerLubrication, FollowsTheExactSeriesAtEveryGap) {
  for (double gap = 1e-3; gap < 30.0; gap *= 1.5)
    EXPECT_NEAR((1.0 + BrennerLubrication::excess(gap)) / brenner_series(gap), 1.0, 0.02) << gap;
}

FluidPoint lagging(double speed, double rate) {
  // u = rate z along x: its curl is along y. The grain lags behind by `speed`.
  FluidPoint at;
  at.fluid = kWater;
  at.diameter = 1e-3;
  at.slip = {speed, 0, 0};
  at.vorticity = {0, rate, 0};
  return at;
}

template <class Law>
class EveryShearLiftLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryShearLiftLaw, TypesOf<ShearLiftLaw>::Types);

TYPED_TEST(EveryShearLiftLaw, PushesALaggingGrainTowardsTheFasterFluid) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  EXPECT_GT(TypeParam::force(lagging(1e-3, 2.0)).z, 0.0);
  EXPECT_LT(TypeParam::force(lagging(-1e-3, 2.0)).z, 0.0);
  EXPECT_LT(TypeParam::force(lagging(1e-3, -2.0)).z, 0.0);
  EXPECT_EQ(TypeParam::force(lagging(1e-3, 0.0)).z, 0.0);
  EXPECT_EQ(TypeParam::force(lagging(0.0, 2.0)).z, 0.0);
}

TYPED_TEST(EveryShearLiftLaw, IsSaffmansAtSmallReynoldsNumber) {
  // 6.46 mu a^2 |u - v| sqrt(rate/nu), a = d/2.
  const double speed = 1e-6;
  const double rate = 1e-3;
  const double saffman = 6.46 * 1e-3 * 0.25e-6 * speed * std::sqrt(rate / 1e-6);
  EXPECT_NEAR(TypeParam::force(lagging(speed, rate)).z / saffman, 1.0, 2e-3);
}

TEST(SaffmanMeiLift, JoinsItsTwoPartsAtReynolds40) {
  // Within the 0.0183 (1 - root) left of the exponential and the fit's rounding.
  for (const double shear : {0.01, 0.1, 0.4})
    EXPECT_NEAR(SaffmanMeiLift::correction(40.0, shear), SaffmanMeiLift::correction(40.001, shear),
                0.02);
}

template <class Law>
class EverySpinLiftLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EverySpinLiftLaw, TypesOf<SpinLiftLaw>::Types);

TYPED_TEST(EverySpinLiftLaw, PushesABallWithTopspinDown) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  FluidPoint at = lagging(-1e-3, 0.0);  // flies forward through fluid at rest
  at.spin = {0, 10.0, 0};               // its top moves forward
  EXPECT_LT(TypeParam::force(at).z, 0.0);
  at.spin = {0, -10.0, 0};
  EXPECT_GT(TypeParam::force(at).z, 0.0);
  at.spin = {};
  EXPECT_EQ(TypeParam::force(at).z, 0.0);
}

TYPED_TEST(EverySpinLiftLaw, IsRubinowAndKellersAtSmallReynoldsNumber) {
  FluidPoint at = lagging(-1e-9, 0.0);
  at.spin = {0, 2e-5, 0};
  // pi rho a^3 W v
  const double exact = -kPi * 1000.0 * 0.125e-9 * 2e-5 * 1e-9;
  EXPECT_NEAR(TypeParam::force(at).z / exact, 1.0, 0.02);
}

template <class Law>
class EverySpinDragLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EverySpinDragLaw, TypesOf<SpinDragLaw>::Types);

TYPED_TEST(EverySpinDragLaw, IsTheCreepingTorqueOfASlowSpin) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  FluidPoint at = lagging(0.0, 0.0);
  at.spin = {0, 1.0, 0};
  EXPECT_NEAR(TypeParam::coefficient(at) / (8.0 * kPi * 1e-3 * 0.125e-9), 1.0, 1e-12);
}

TYPED_TEST(EverySpinDragLaw, NeverFallsWithTheSpin) {
  double before = 0.0;
  for (double rotation = 0.1; rotation < 1000.0; rotation *= 1.1) {
    EXPECT_GE(TypeParam::factor(rotation), before - 1e-12);
    // The two regimes of Dennis et al. meet within 0.3 %.
    EXPECT_NEAR(TypeParam::factor(1.001 * rotation), TypeParam::factor(rotation), 3e-3);
    before = TypeParam::factor(rotation);
  }
}

template <class Law>
class EveryAddedMassLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryAddedMassLaw, TypesOf<AddedMassLaw>::Types);

TYPED_TEST(EveryAddedMassLaw, IsHalfOfTheDisplacedFluidForASingleSphere) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  EXPECT_DOUBLE_EQ(TypeParam::share(1.0), 0.5);
  EXPECT_GE(TypeParam::share(0.6), 0.5);
}

template <class Law>
class EveryHistoryLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryHistoryLaw, TypesOf<HistoryLaw>::Types);

TYPED_TEST(EveryHistoryLaw, HasBassetsKernelAtShortTimes) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  const double memory = TypeParam::memory(lagging(1e-2, 0.0));
  EXPECT_GT(memory, 0.0);
  EXPECT_TRUE(std::isinf(TypeParam::memory(lagging(0.0, 0.0))));
}

TEST(MeiAdrianHistory, ForgetsAsThePublishedKernelDoes) {
  const FluidPoint at = lagging(1e-2, 0.0);  // Re = 10
  const double d = at.diameter;
  const double nu = 1e-6;
  const double f = 0.75 + 0.105 * 10.0;
  const double memory = MeiAdrianHistory::memory(at);
  for (double t = 1e-6; t < 1e3; t *= 10.0) {
    const double published = std::pow(std::pow(4.0 * kPi * t * nu / (d * d), 0.25) +
                                          std::sqrt(kPi * 1e-6 * t * t / (d * nu * f * f * f)),
                                      -2.0);
    const double ours =
        d / std::sqrt(4.0 * kPi * nu * t) * std::pow(1.0 + std::pow(t / memory, 0.75), -2.0);
    EXPECT_NEAR(ours / published, 1.0, 1e-12) << t;
  }
}

TEST(HistoryModes, AddUpToTheKernelOverSevenDecades) {
  const double dt = 1e-5;
  const HistoryModes modes(dt);
  for (const double memory : {HUGE_VAL, 1e3, 1.0, 1e-3}) {
    const auto weights = modes.weights(memory);
    for (double t = 0.5 * dt; t < 1e7 * dt; t *= 1.5) {
      const double x = std::isinf(memory) ? 0.0 : std::pow(t / memory, 0.75);
      const double exact = 1.0 / (std::sqrt(t) * (1.0 + x) * (1.0 + x));
      // Rates a factor e apart: 5e-4 of Basset's smooth kernel. One that is forgotten bends at its
      // memory time, and is then a small difference of large terms.
      EXPECT_NEAR(modes.kernel(weights, t), exact,
                  std::isinf(memory) ? 5e-4 * exact : 3e-3 * exact + 1e-4 / std::sqrt(t))
          << memory << " " << t;
    }
  }
}

TEST(HistoryModes, IntegrateAConstantAccelerationAsTheoryDoes) {
  // Integral of a (t - s)^(-1/2) from 0 to t: 2 a sqrt(t), here to the middle of step n.
  const double dt = 1e-4;
  const HistoryModes modes(dt);
  const auto weights = modes.weights(HUGE_VAL);
  HistoryModes::Memory memory{};
  const Vec3 a{1.0, -2.0, 0.5};
  for (int n = 0; n < 3000; ++n) {
    const Vec3 all = modes.past(weights, memory) + modes.local_weight() * a;
    EXPECT_NEAR(all.y / (2.0 * a.y * std::sqrt((n + 0.5) * dt)), 1.0, 5e-4) << n;
    modes.remember(a, memory);
  }
}

}  // namespace
}  // namespace grouser
