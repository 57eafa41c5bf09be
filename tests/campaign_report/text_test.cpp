// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "campaign/report/csv.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/observables.hpp"
#include "campaign/report/run_output.hpp"
#include "markup.hpp"
#include "synthetic.hpp"

namespace grouser {
namespace {

TEST(EscapeHtml, LeavesNothingThatCouldBeMarkup) {
  EXPECT_EQ(escape_html("<script>alert('x\"&')</script>"),
            "&lt;script&gt;alert(&#39;x&quot;&amp;&#39;)&lt;/script&gt;");
}

TEST(EscapeHtml, KeepsUtf8AndReplacesTheRest) {
  EXPECT_EQ(escape_html("ωr − 20 µm"), "ωr − 20 µm");
  EXPECT_EQ(escape_html("a\xff\xc3"), "a\uFFFD\uFFFD");
  EXPECT_EQ(escape_html(std::string_view("a\0b\x1b", 4)), "a\uFFFDb\uFFFD");
}

TEST(ShownNumber, IsForPeople) {
  EXPECT_EQ(shown_number(-1.25, 1), "−1.2");
  EXPECT_EQ(shown_number(-0.001, 1), "0.0");
  EXPECT_EQ(shown_number(kNaN, 1), "–");
  EXPECT_EQ(shown_count(36037017), "36\u202F037\u202F017");
  EXPECT_EQ(shown_count(-1234), "−1\u202F234");
  EXPECT_EQ(shown_duration(59.94), "59.9 s");
  EXPECT_EQ(shown_duration(7505), "2 h 05 min");
  EXPECT_EQ(coordinate(-0.0001), "0");
  EXPECT_EQ(coordinate(100.0), "100");
}

TEST(Csv, ReadsQuotesCommasAndLineEnds) {
  const CsvTable table = parse_csv("a,b\r\n\n\"x, \"\"y\"\"\nz\",2\n");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0][0], "x, \"y\"\nz");
  EXPECT_EQ(table.rows[0][1], "2");
  EXPECT_EQ(table.lines[0], 3);
  EXPECT_FALSE(table.column("c").has_value());
}

TEST(Csv, WhatIsWrittenReadsBack) {
  CsvWriter csv;
  csv.cell(std::string("head, \"quoted\""));
  csv.cell(0.1);
  csv.cell(kNaN);
  csv.end_row();
  const CsvTable table = parse_csv("a,b,c\n" + csv.text());
  EXPECT_EQ(table.rows[0], (std::vector<std::string>{"head, \"quoted\"", "0.1", ""}));
}

TEST(Csv, NumbersAreWholeCellsOnly) {
  EXPECT_DOUBLE_EQ(number_of("-1e-3"), -1e-3);
  for (const char* const text : {"", "1 N", "x", "1,0"}) EXPECT_TRUE(std::isnan(number_of(text)));
}

TEST(Series, HalfARowIsLeftOut) {
  const std::string whole =
      synthetic::series_text("slip_20", synthetic::case_of("slip_20", 1), 1, 0.1);
  const RunSeries all = parse_series(whole, "s");
  const RunSeries cut = parse_series(whole.substr(0, whole.size() - 4), "s");
  EXPECT_EQ(cut.size(), all.size() - 1);
  EXPECT_TRUE(std::isnan(all.of(Observable::kPullCoefficient)[0])) << "settling has no pull";
}

TEST(Series, AMissingColumnIsNamed) {
  try {
    parse_series("time [s],phase\n1,driving\n", "runs/a/series.csv");
    FAIL() << "accepted";
  } catch (const FormatError& error) {
    EXPECT_EQ(std::string(error.what()), "runs/a/series.csv: column 'travel [m]' is missing");
  }
}

TEST(Slice, IsThinnedAndDamagedRowsAreLeftOut) {
  std::string text = "kind,x [m],z [m],radius [m],displacement [m]\n";
  for (int i = 0; i < 100; ++i) text += "grain,0.5,0.1,0.01,0.002\n";
  text += "grain,nan,0.1,0.01,0\ngrain,0.1,0.1,-1,0\ngrain,0.1\nwheel,0.2,0.3,,\nbox,1.2,0.2,,\n";
  const BedSlice slice = parse_slice(text, "s", 30);
  EXPECT_EQ(slice.every, 4u);
  EXPECT_EQ(slice.grains.size(), 25u);
  EXPECT_EQ(slice.wheel.size(), 1u);
  EXPECT_DOUBLE_EQ(slice.box_length, 1.2);
}

TEST(Slip, DefinitionsAgreeWhenDriven) {
  EXPECT_DOUBLE_EQ(slip_of(SlipDefinition::kPowered, 2.0, 1.0), 0.5);
  EXPECT_DOUBLE_EQ(slip_of(SlipDefinition::kBounded, 2.0, 1.0), 0.5);
  EXPECT_DOUBLE_EQ(slip_of(SlipDefinition::kBounded, 0.0, 1.0), -1.0);
  EXPECT_TRUE(std::isnan(slip_of(SlipDefinition::kPowered, 0.0, 1.0)));
}

TEST(Slip, ConversionIsTheSameAsMeasuring) {
  for (const double rim : {0.1, 0.5, 0.9, 1.0, 1.5, 10.0}) {
    const double powered = slip_of(SlipDefinition::kPowered, rim, 1.0);
    const double bounded = slip_of(SlipDefinition::kBounded, rim, 1.0);
    EXPECT_NEAR(convert_slip(powered, SlipDefinition::kPowered, SlipDefinition::kBounded), bounded,
                1e-14);
    EXPECT_NEAR(convert_slip(bounded, SlipDefinition::kBounded, SlipDefinition::kPowered), powered,
                1e-14);
  }
  EXPECT_TRUE(std::isnan(convert_slip(-1.0, SlipDefinition::kBounded, SlipDefinition::kPowered)));
}

}  // namespace
}  // namespace grouser
