// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "campaign/report/colour_map.hpp"
#include "campaign/report/observables.hpp"
#include "markup.hpp"

namespace grouser {
namespace {

TEST(NiceAxis, CoversTheDataWithFewRoundSteps) {
  std::mt19937 engine(7);
  for (int i = 0; i < 2000; ++i) {
    const double scale = std::pow(10.0, static_cast<double>(engine() % 12) - 6.0);
    const double low = scale * (static_cast<double>(engine() % 2000) / 1000.0 - 1.0);
    const double high = low + scale * static_cast<double>(1 + engine() % 1000) / 1000.0;
    const PlotAxis axis = nice_axis(low, high, 5);
    SCOPED_TRACE(testing::Message() << low << " to " << high);
    EXPECT_LE(axis.low, low + 1e-6 * axis.step);
    EXPECT_GE(axis.high, high - 1e-6 * axis.step);
    EXPECT_GE(axis.ticks().size(), 3u);
    EXPECT_LE(axis.ticks().size(), 10u);
    const double lead = axis.step / std::pow(10.0, std::floor(std::log10(axis.step) + 1e-9));
    EXPECT_TRUE(std::abs(lead - 1) < 1e-6 || std::abs(lead - 2) < 1e-6 || std::abs(lead - 5) < 1e-6)
        << lead;
  }
}

TEST(NiceAxis, TicksAreToldApartByTheirDecimals) {
  EXPECT_EQ(nice_axis(0.0, 40.0).decimals, 0);
  EXPECT_EQ(nice_axis(0.0, 0.34).decimals, 2);
  EXPECT_EQ(nice_axis(0.0, 1.0, 5).decimals, 1);
}

TEST(NiceAxis, TakesWhatItIsGiven) {
  for (const auto& [low, high] :
       {PlotPoint{3.0, 3.0}, PlotPoint{0.0, 0.0}, PlotPoint{kNaN, kNaN}, PlotPoint{2.0, kNaN},
        PlotPoint{5.0, 1.0}, PlotPoint{-1e-300, 1e-300}}) {
    const PlotAxis axis = nice_axis(low, high);
    EXPECT_LT(axis.low, axis.high) << low << " " << high;
    EXPECT_TRUE(std::isfinite(axis.step));
    EXPECT_LT(axis.ticks().size(), 20u);
  }
}

TEST(ThinCurve, KeepsPeaksAndOrder) {
  std::vector<PlotPoint> curve;
  for (int i = 0; i < 10000; ++i) curve.emplace_back(i, i == 5000 ? 9.0 : (i == 7001 ? kNaN : 1.0));
  const std::vector<PlotPoint> thin = thin_curve(curve, 100);
  EXPECT_LE(thin.size(), 200u);
  double highest = 0.0;
  for (std::size_t i = 0; i < thin.size(); ++i) {
    highest = std::max(highest, thin[i].second);
    if (i > 0) {
      EXPECT_GT(thin[i].first, thin[i - 1].first);
    }
  }
  EXPECT_DOUBLE_EQ(highest, 9.0);
  EXPECT_TRUE(thin_curve({}, 10).empty());
}

TEST(PlotSvg, LeavesOutWhatIsNotFinite) {
  Plot plot("a & b", "<d>", nice_axis(0, 1), nice_axis(0, 1), "x", "y");
  plot.line({{0.0, kNaN}, {kNaN, 1.0}}, {"mean", "none"});
  plot.line({{0.0, 0.0}, {0.5, kNaN}, {1.0, 1.0}}, {"mean", "kept"});
  plot.marker({kNaN, 0.0}, Marker::kDot, {"seed", "run"}, "");
  plot.error_bar({0.5, 0.5}, kNaN, {"bar", ""});
  plot.shade(kNaN, 1.0, {"window", "window"}, "");
  const std::string svg = plot.svg();
  EXPECT_EQ(markup::first_fault(svg), "");
  EXPECT_EQ(markup::count_of(svg, "data-series"), 1);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(ColourMap, LightnessRisesEvenly) {
  double last = lightness_of(colour_at(0.0));
  for (int i = 1; i <= 100; ++i) {
    const double lightness = lightness_of(colour_at(i / 100.0));
    EXPECT_NEAR(lightness - last, 0.0063, 0.0005) << "at " << i << " %";
    last = lightness;
  }
}

TEST(ColourMap, ClampsWhatIsOutside) {
  EXPECT_EQ(hex_of(colour_at(-3.0)), hex_of(colour_at(0.0)));
  EXPECT_EQ(hex_of(colour_at(7.0)), hex_of(colour_at(1.0)));
  EXPECT_EQ(hex_of(colour_at(kNaN)), hex_of(colour_at(0.0)));
}

}  // namespace
}  // namespace grouser
