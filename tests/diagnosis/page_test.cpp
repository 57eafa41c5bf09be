// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/report/page.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace grouser::diagnosis {
namespace {

namespace fs = std::filesystem;

SeriesRecording recording() {
  SeriesRecording r;
  r.name = "falls";
  r.title = "Falls <script>alert(1)</script> & more";
  r.channels.resize(1);
  r.channels[0].name = "gap";
  r.conditions.resize(2);
  r.conditions[0].name = "A";
  r.conditions[1].name = "D";
  r.conditions[1].split = "held_out";
  return r;
}

Curves curves(const std::string& name, bool is_held_out) {
  Curves c{name, is_held_out, {}, {{}}, {{}}, {{}}, {1e-3}};
  for (int i = 0; i < 200; ++i) {
    const double t = 0.005 * i;
    c.times.push_back(t);
    c.recorded[0].push_back(0.1 - 0.1 * t + (i % 2 == 0 ? 1e-3 : -1e-3));
    c.before[0].push_back(0.1 - 0.08 * t);
    c.after[0].push_back(0.1 - 0.1 * t);
  }
  return c;
}

Diagnosis diagnosis() {
  Diagnosis d;
  d.recording = "falls";
  d.word = Word::kNamed;
  d.cause = "basset";
  d.probability = 0.9;
  d.set = {"basset"};
  d.confusable = {"basset", "release_force"};
  d.amplitude = 1.1;
  d.amplitude_error = 0.1;
  d.amplitudes = {1.0, 1.2};
  d.amplitude_errors = {0.2, 0.2};
  d.curves = {curves("D", true), curves("A", false)};
  d.flags = {"viscosity is pushed by 2.1 standard deviations"};
  HeldOut held;
  held.condition = "D";
  held.baseline_error = 0.05;
  held.candidate_error = 0.01;
  held.placebos = {{"drift", -1.0}};
  d.held_out = {held};
  Candidate cause;
  cause.id = "basset";
  cause.probability = 0.9;
  d.candidates = {cause};
  d.detection.draws = {1.0, 2.0, 3.0, 2.5};
  d.detection.cells = {{0, 0, 10, 20, 9.0}};
  Location place{"A",
                 {0.0, 0.5, 1.0},
                 {0.1, 1.0, 0.2},
                 {false, true, false},
                 {0.0, 0.1, 0.0},
                 {0.02, 0.02, 0.02}};
  d.locations = {place};
  return d;
}

TEST(DiagnosisPage, BeginsWithTheVerdictAndShowsWhatWasHeldOutBeforeAndAfter) {
  const std::string page = page_html(diagnosis(), recording());
  EXPECT_LT(page.find("Basset history force, 90 % of the odds"), page.find("<main>"));
  const std::size_t held = page.find("D: held out, never fitted");
  ASSERT_NE(held, std::string::npos);
  EXPECT_LT(held, page.find("A: fitted"));
  for (const char* const series : {"recorded", "before", "after", "noise", "latent", "null"})
    EXPECT_NE(page.find(std::string("data-series=\"") + series + "\""), std::string::npos)
        << series;
  for (const char* const text :
       {"5 %", "pushed by 2.1", "release again in another way", "where theory has 1"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
}

TEST(DiagnosisPage, TakesNoTextForMarkupAndLoadsNothing) {
  const std::string page = page_html(diagnosis(), recording());
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST(DiagnosisPage, IsPaintedByABrowserWithoutComplaint) {
  const fs::path folder = fs::path(testing::TempDir()) / "diagnosis_page";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ofstream(folder / "page.html") << page_html(diagnosis(), recording());
  const std::string command =
      "cd '" + folder.string() +
      "' && timeout 120 chromium --headless --no-sandbox --disable-gpu --no-first-run "
      "--disable-background-networking --hide-scrollbars --enable-logging=stderr "
      "--window-size=1000,2400 --user-data-dir=profile --screenshot=page.png page.html "
      ">out 2>err";
  const int status = std::system(command.c_str());
  std::ostringstream complaints;
  complaints << std::ifstream(folder / "err").rdbuf();
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << complaints.str();
  EXPECT_EQ(complaints.str().find("CONSOLE"), std::string::npos) << complaints.str();
  // A page without drawings would be a few kilobytes of flat colour.
  EXPECT_GT(fs::file_size(folder / "page.png"), 40000U);
}

}  // namespace
}  // namespace grouser::diagnosis
