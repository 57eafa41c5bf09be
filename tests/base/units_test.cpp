// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"

#include <gtest/gtest.h>

namespace grouser {
namespace {

TEST(Units, ReadTheFieldsOwnUnits) {
  EXPECT_DOUBLE_EQ(parse_quantity("71.27 cm", "m"), 0.7127);
  EXPECT_NEAR(parse_quantity("42 lbf", "N"), 42 * 0.45359237 * 9.80665, 1e-9);
  EXPECT_NEAR(parse_quantity("66 in/s", "m s-1"), 66 * 0.0254, 1e-12);
  EXPECT_DOUBLE_EQ(parse_quantity("20 %", "1"), 0.2);
}

TEST(Units, ReadDurationsAsBatchSystemsWriteThem) {
  EXPECT_EQ(parse_quantity("8h", "s"), 28800);
  EXPECT_EQ(parse_quantity("08:00:30", "s"), 28830);
}

TEST(Units, RefuseABareNumberForALength) {
  EXPECT_THROW(parse_quantity("5", "m"), std::invalid_argument);
  EXPECT_THROW(parse_quantity("3 s", "m"), std::invalid_argument);
  EXPECT_THROW(parse_quantity("nan m", "m"), std::invalid_argument);
  EXPECT_THROW(parse_quantity("", "m"), std::invalid_argument);
  EXPECT_THROW(parse_quantity("1e308 km", "m"), std::invalid_argument);
}

TEST(Units, RefuseWhatIsNoFiniteNumberInAnySpelling) {
  for (const char* text : {"nan", ".nan m", "NaN m", "inf m", "-inf m", ".inf m", "infinity m",
                           "1e400 m", "1e-400 m", "1e306 km", "0x1p3 m"}) {
    EXPECT_THROW(parse_quantity(text, "m"), std::invalid_argument) << text;
    EXPECT_THROW(parse_quantity(text, "1"), std::invalid_argument) << text;
  }
}

TEST(Units, WriteNumbersThatReadBackToTheSameBits) {
  for (const double value : {0.1, 1.0 / 3.0, 6.02e23, -1e-300, 0.76e-3})
    EXPECT_EQ(parse_quantity(format_quantity(value, "m"), "m"), value);
}

}  // namespace
}  // namespace grouser
