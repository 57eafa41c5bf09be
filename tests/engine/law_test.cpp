// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <type_traits>

#include "base/case.hpp"
#include "engine/dem/history_view.hpp"
#include "engine/dem/laws/table.hpp"

namespace grouser {
namespace {

constexpr Solid kGlass{7e10, 0.25};

// Every law of the table, and so every law added to it.
template <class Law>
class EveryContactLaw : public ::testing::Test {};
template <class Variant>
struct TypesOf;
template <class... Law>
struct TypesOf<std::variant<Law...>> {
  using Types = ::testing::Types<Law...>;
};
TYPED_TEST_SUITE(EveryContactLaw, TypesOf<ContactLaw>::Types);

template <class Law>
class EveryRollingLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryRollingLaw, TypesOf<RollingLaw>::Types);

ContactPoint pressed(double overlap) {
  ContactPoint at;
  at.overlap = overlap;
  at.radius = 1e-3;
  at.mass = 1e-5;
  at.normal = {0, 0, 1};
  return at;
}

TYPED_TEST(EveryContactLaw, SaysWhereItComesFromAndWhatItRemembers) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  std::size_t width = 0;
  for (const StateField& field : TypeParam::history_fields()) {
    EXPECT_FALSE(field.unit.empty());
    width += static_cast<std::size_t>(field.width);
  }
  EXPECT_EQ(width, (HistoryView<TypeParam, NoRolling>::kLaw));
}

TYPED_TEST(EveryContactLaw, NeverPullsAndNeverExceedsFriction) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto law = TypeParam::from_parameters(kGlass, kGlass, {0.3, 0.4, 0.0});
  typename TypeParam::History history;
  for (int i = 0; i < 10000; ++i) {
    ContactPoint at = pressed(1e-6 * (1.001 + unit(random)));
    at.normal_velocity = unit(random);
    at.slip_velocity = {unit(random), unit(random), 0.0};
    const ContactForce force = law.evaluate(at, history, 1e-7);
    ASSERT_GE(force.normal, 0.0);
    ASSERT_LE(norm(force.tangential), 0.4 * force.normal * (1 + 1e-12));
    ASSERT_EQ(dot(force.tangential, at.normal), 0.0);
  }
}

// Presses, shears, presses more (or less), shears back, lets go: the work done on the contact over
// the loop must not be negative, whatever the order of magnitude of friction.
TYPED_TEST(EveryContactLaw, CreatesNoEnergyOverAClosedLoop) {
  for (const double friction : {0.1, 0.5, 1e3})
    for (const double deeper : {0.5, 1.0, 2.0}) {
      const auto law = TypeParam::from_parameters(kGlass, kGlass, {1.0, friction, 0.0});
      typename TypeParam::History history;
      double z = 0.0;
      double work = 0.0;
      double scale = 0.0;
      const double dt = 1e-9;
      const auto move = [&](const Vec3& by) {
        const int steps = 4000;
        for (int s = 0; s < steps; ++s) {
          const Vec3 part = (1.0 / steps) * by;
          z += part.z;
          ContactPoint at = pressed(std::max(z, 0.0));
          // Overlap grows as a approaches b.
          at.normal_velocity = -part.z / dt;
          at.slip_velocity = (1.0 / dt) * Vec3{part.x, part.y, 0.0};
          if (z <= 0.0) continue;
          const ContactForce force = law.evaluate(at, history, dt);
          const double done = force.normal * part.z - dot(force.tangential, part);
          work += done;
          scale += std::abs(done);
        }
      };
      move({0, 0, 2e-6});
      move({1e-6, 0, 0});
      move({0, 0, 2e-6 * (deeper - 1.0)});
      move({-1e-6, 0, 0});
      move({0, 0, -2e-6 * deeper});
      // One step of 1/4000 of the path is the quadrature error of the work.
      EXPECT_GE(work, -1e-3 * scale) << "friction " << friction << " deeper " << deeper;
    }
}

TYPED_TEST(EveryRollingLaw, SaysWhereItComesFromAndWhatItRemembers) {
  EXPECT_GT(std::string(TypeParam::kSource).size(), 8u);
  std::size_t width = 0;
  for (const StateField& field : TypeParam::history_fields())
    width += static_cast<std::size_t>(field.width);
  EXPECT_EQ(width, (HistoryView<HertzMindlin, TypeParam>::kRolling));
}

TYPED_TEST(EveryRollingLaw, OpposesRollingAndStaysBelowItsLimit) {
  const auto law = TypeParam::from_parameters({1.0, 0.5, 0.2});
  typename TypeParam::History history;
  ContactPoint at = pressed(1e-6);
  at.rolling_rate = {3.0, 0.0, 0.0};
  ContactForce force;
  force.normal = 2.0;
  force.stiffness = 1e6;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 moment = law.evaluate(at, force, history, 1e-6);
    ASSERT_LE(dot(moment, at.rolling_rate), 0.0);
    ASSERT_LE(norm(moment), 0.2 * at.radius * force.normal * (1 + 1e-12));
  }
}

// The case reader lists the laws' names without knowing the engine; both lists must be one.
class WordsOf : public FieldVisitor {
 public:
  explicit WordsOf(std::string key) : key_(std::move(key)) {}
  void quantity(const Field&, double&, const char*, Range) override {}
  void integer(const Field&, std::int64_t&, std::int64_t, std::int64_t) override {}
  void flag(const Field&, bool&) override {}
  void word(const Field& field, std::string&, const std::vector<std::string>& choices) override {
    if (key_ == field.key) words = choices;
  }
  // Other groups have laws of their own.
  void group(const Field& field, const Body& body) override {
    if (std::string_view(field.key) == "contact") body(*this);
  }
  void optional_group(const Field&, bool&, const Body&) override {}
  void list(const Field&, std::size_t, const std::function<void(std::size_t)>&,
            const ItemBody&) override {}
  void rule(const char*, bool, const std::string&, const std::string&) override {}
  void check(const char*, bool, const std::string&, const std::string&) override {}
  void raw(const Field&, YamlNode&) override {}

  std::vector<std::string> words;

 private:
  std::string key_;
};

template <class... Law>
std::vector<std::string> names_of(std::type_identity<std::variant<Law...>>) {
  return {Law::kName...};
}

// A spring turned by `angle` from a contact plane along x to one that is tilted by it, in `steps`.
// @return its length over that at the start
double length_after_turn(double angle, int steps) {
  const auto law = HertzMindlin::from_parameters(kGlass, kGlass, {0.9, 1e3, 0.0});
  HertzMindlin::History history;
  ContactPoint at = pressed(1e-6);
  law.evaluate(at, history, 1e-7);
  const double start = 1e-3;
  history.spring = {start, 0.0, 0.0};
  for (int i = 1; i <= steps; ++i) {
    const double turned = angle * i / steps;
    at.normal = {-std::sin(turned), 0.0, std::cos(turned)};
    law.evaluate(at, history, 1e-7);
  }
  EXPECT_NEAR(dot(history.spring, at.normal), 0.0, 1e-12 * start);
  return norm(history.spring) / start;
}

// Laid into each new plane alone it would lose 1.2e-3 over a quarter turn of a thousand steps. What
// stands for the root is short by (tan of a step)^6 / 32, rounding by some 1e-16 a step.
TEST(HertzMindlin, ASpringKeepsItsLengthWhenItsContactTurns) {
  EXPECT_NEAR(length_after_turn(0.5 * std::numbers::pi, 1000), 1.0, 1e-12);
}

// Of a turn by 30 degrees at once (4 + 3 x) / (4 + x) is short by 0.08 %, x = 1/3; never too long.
TEST(HertzMindlin, ASpringNeverGrowsWhenItsContactTurns) {
  const double kept = length_after_turn(std::numbers::pi / 6.0, 1);
  EXPECT_LE(kept, 1.0);
  EXPECT_GT(kept, 0.999);
}

TEST(LawTable, HasTheNamesThatTheCaseReaderAccepts) {
  Case input;
  WordsOf law("law");
  describe(law, input);
  EXPECT_EQ(law.words, names_of(std::type_identity<ContactLaw>{}));
  WordsOf rolling("rolling");
  describe(rolling, input);
  EXPECT_EQ(rolling.words, names_of(std::type_identity<RollingLaw>{}));
}

}  // namespace
}  // namespace grouser
