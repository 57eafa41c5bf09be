// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "campaign/report/html.hpp"
#include "campaign/report/page.hpp"
#include "markup.hpp"
#include "synthetic.hpp"
#include "tests/support/browser.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

std::string report() {
  const ReportData data = synthetic::campaign(2);
  return report_html(data, analyse(data));
}

/// A page that shows `html` in a frame as wide as a given screen, measures it with a script of its
/// own and writes the findings into its own attributes.
std::string measuring_page(const std::string& html, int width) {
  std::string inner = html;
  // The report allows no script at all; the frame's measuring comes from outside.
  const std::size_t from = inner.find("<meta http-equiv");
  inner.erase(from, inner.find('\n', from) - from);
  return "<!DOCTYPE html><html><body style=\"margin:0\"><iframe "
         "style=\"border:0;height:900px;width:" +
         std::to_string(width) + "px\" srcdoc=\"" + escape_html(inner) + "\"></iframe><script>" +
         R"js(
    const frame = document.querySelector("iframe");
    frame.addEventListener("load", () => {
      const page = frame.contentDocument;
      const visible = [...page.querySelectorAll("svg path[data-series], svg circle[data-series]")]
          .filter(shape => { const b = shape.getBoundingClientRect(); return b.width + b.height > 0; });
      const wide = [...page.querySelectorAll("h1, h2, p, figure, .card, svg, .scroll, nav")]
          .filter(e => e.getBoundingClientRect().right > frame.clientWidth + 0.5);
      const outside = [...page.querySelectorAll("svg.plot")].filter(plot => {
        const box = plot.getBoundingClientRect();
        return [...plot.querySelectorAll("text, path, circle, rect")].some(part => {
          const b = part.getBoundingClientRect();
          return b.left < box.left - 1 || b.right > box.right + 1 || b.top < box.top - 1 ||
                 b.bottom > box.bottom + 1;
        });
      });
      const small = [...page.querySelectorAll("svg.plot text")].map(t => {
        const plot = t.ownerSVGElement;
        return parseFloat(getComputedStyle(t).fontSize) * plot.getBoundingClientRect().width /
               plot.viewBox.baseVal.width;
      });
      const result = document.documentElement;
      result.setAttribute("data-scroll-width", page.documentElement.scrollWidth);
      result.setAttribute("data-shapes", visible.length);
      result.setAttribute("data-too-wide", wide.length);
      result.setAttribute("data-outside", outside.length);
      result.setAttribute("data-smallest-text", Math.min(...small).toFixed(1));
    });)js" +
         "</script></body></html>";
}

double attribute_of(const std::string& dom, const std::string& name) {
  std::smatch match;
  if (!std::regex_search(dom, match, std::regex(name + "=\"([-0-9.]+)\""))) return -1.0;
  return std::stod(match[1]);
}

class PageAtWidth : public testing::TestWithParam<int> {};

// Three plots of mean, band, towed, 12 runs; recorded values; 24 run plots with 36 traces and 24
// windows; 6 wheels. Windows are rectangles and not counted.
TEST_P(PageAtWidth, ShowsItsCurvesWithinTheScreen) {
  const Browser browser;
  std::string errors;
  const fs::path page = browser.write("measure.html", measuring_page(report(), GetParam()));
  const std::string dom =
      browser.run("--window-size=1600,1200 --virtual-time-budget=5000 --dump-dom", page, errors);
  EXPECT_EQ(attribute_of(dom, "data-shapes"), 3 * (1 + 1 + 1 + 12) + 6 + 36 + 6);
  EXPECT_EQ(attribute_of(dom, "data-scroll-width"), GetParam());
  EXPECT_EQ(attribute_of(dom, "data-too-wide"), 0);
  EXPECT_EQ(attribute_of(dom, "data-outside"), 0) << "something of a plot is cut off";
  EXPECT_GE(attribute_of(dom, "data-smallest-text"), 9.5) << "CSS pixels";
}

INSTANTIATE_TEST_SUITE_P(Screens, PageAtWidth, testing::Values(320, 375, 768, 1280));

TEST(PageInBrowser, HasNoErrorsAndTheWholeDocument) {
  const Browser browser;
  std::string errors;
  const fs::path page = browser.write("report.html", report());
  const std::string dom = browser.run("--dump-dom", page, errors);
  EXPECT_EQ(errors.find("CONSOLE"), std::string::npos) << errors;
  EXPECT_EQ(markup::count_of(dom, "data-series=\"mean\""), 3);
  EXPECT_EQ(markup::count_of(dom, "class=\"bed\""), 6);
  EXPECT_GT(markup::count_of(dom, "<circle"), 6 * 1000);
}

TEST(PageInBrowser, CanBePainted) {
  const Browser browser;
  std::string errors;
  const fs::path page = browser.write("report.html", report());
  const fs::path picture = browser.folder() / "report.png";
  browser.run("--window-size=1280,2400 --screenshot='" + picture.string() + "'", page, errors);
  ASSERT_TRUE(fs::exists(picture)) << errors;
  EXPECT_GT(fs::file_size(picture), 50000u) << "an empty page compresses to a few kilobytes";
}

}  // namespace
}  // namespace grouser
