// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/units.hpp"
#include "campaign/cli/command_list.hpp"
#include "campaign/cli/drive_options.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/json_text.hpp"
#include "campaign/cli/progress.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/cli/wish.hpp"
#include "driving.hpp"
#include "schedulers/command.hpp"
#include "schedulers/local.hpp"

namespace grouser {
namespace {

std::string problems_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(JsonText, IsValidWhateverSqliteAnswers) {
  Table table;
  table.columns = {"number", "infinite", "negative", "nothing", "text", "bytes"};
  table.rows = {{"1.5", "Inf", "-Inf", "", "", "a\xff\xfe"}};
  table.is_text = {{false, false, false, false, true, true}};
  const Json rows = Json::parse(json_text(rows_json(table)));
  EXPECT_EQ(rows[0]["number"], 1.5);
  EXPECT_TRUE(rows[0]["infinite"].is_null());
  EXPECT_TRUE(rows[0]["negative"].is_null());
  EXPECT_TRUE(rows[0]["nothing"].is_null());
  EXPECT_EQ(rows[0]["text"], "");
  EXPECT_EQ(rows[0]["bytes"], "a\xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(json_text(Json{{"x", NAN}}), "{\n  \"x\": null\n}\n");
}

TEST(JsonText, ColumnsOfOneNameAreRefused) {
  Table table;
  table.columns = {"label", "state", "label"};
  EXPECT_EQ(problems_of([&] { rows_json(table); }),
            "query: two columns are called 'label'; JSON needs names of their own: say AS NAME");
}

TEST(JsonText, ACaseIsNumbersInSiUnits) {
  Case input;
  input.box.length = 0.4;
  input.grains.seed = 7;
  input.grains.size_curve = {{4e-4, 0.0}, {8e-4, 1.0}};
  Json json = case_json(input);
  EXPECT_EQ(json["box"]["length"], 0.4);
  EXPECT_EQ(json["grains"]["seed"], 7);
  EXPECT_EQ(json["grains"]["size_curve"][1]["diameter"], 8e-4);
  EXPECT_EQ(json["contact"]["law"], "hertz_mindlin");
  EXPECT_FALSE(json.contains("wheel"));
  input.has_wheel = true;
  EXPECT_TRUE(case_json(input)["wheel"]["load"].is_number());
}

TEST(CommandList, CompletionsAndManualNameEveryVerbAndOption) {
  CLI::App app("what it is", "grouser");
  int code = 0;
  add_submit(app, code);
  add_status(app, code);
  const auto verbs = list_verbs(app);
  ASSERT_EQ(verbs.size(), 2u);
  std::vector<std::string> texts{manual_page("what it is", verbs)};
  for (const char* shell : {"bash", "zsh", "fish"})
    texts.push_back(completion_script(verbs, shell));
  for (std::string& text : texts) {
    text.erase(std::remove(text.begin(), text.end(), '\\'), text.end());
    for (const char* part : {"submit", "status", "dry-run", "watch"})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(CommandList, CompletionsAreGoodShell) {
  CLI::App app("what it is", "grouser");
  int code = 0;
  add_submit(app, code);
  add_query(app, code);
  TemporaryDirectory directory;
  const auto file = directory.path() / "completion.bash";
  write_atomic(file, completion_script(list_verbs(app), "bash"));
  const auto done = run_command(
      {"bash", "-c",
       "source \"$0\"; COMP_WORDS=(grouser sub); COMP_CWORD=1; _grouser; echo \"${COMPREPLY[*]}\"; "
       "COMP_WORDS=(grouser submit --dry); COMP_CWORD=2; _grouser; echo \"${COMPREPLY[*]}\"",
       file.string()},
      10.0);
  EXPECT_EQ(done.out, "submit\n--dry-run\n") << done.err;
}

TEST(DriveOptions, SecondsAreNumbersThatTimeCanTake) {
  const auto takes = [](const std::string& option, const std::string& value) {
    CLI::App app;
    DriveOptions options;
    add_drive_options(app, options);
    std::vector<std::string> words{value, option};  // CLI11 wants them from the last to the first
    try {
      app.parse(words);
      return true;
    } catch (const CLI::ParseError&) {
      return false;
    }
  };
  for (const char* option : {"--every", "--grace"}) {
    EXPECT_TRUE(takes(option, "0.5"));
    for (const char* bad : {"nan", "inf", "-1", "soon", ""})
      EXPECT_FALSE(takes(option, bad)) << option << " " << bad;
  }
  EXPECT_TRUE(takes("--grace", "0"));
  EXPECT_FALSE(takes("--every", "0"));
}

TEST(CheckedPlan, RefusesMoreLocalRanksThanTheMachineCanCarry) {
  TemporaryDirectory directory;
  const auto file = directory.path() / "c.yaml";
  const auto with_ranks = [&](int ranks) {
    write_atomic(file, small_campaign("resources: {ranks: " + std::to_string(ranks) + "}\n"));
    return problems_of([&] { checked_plan(file.string(), ""); });
  };
  const int cores = available_cores();
  EXPECT_EQ(with_ranks(4 * cores), "");
  const std::string text = with_ranks(4 * cores + 1);
  EXPECT_NE(text.find(":22:20: resources.ranks: " + std::to_string(4 * cores + 1) +
                      " ranks are too many for scheduler local here; this process may use " +
                      std::to_string(cores) + " cores"),
            std::string::npos)
      << text;
}

TEST(CheckedPlan, RefusesMoreLocalThreadsThanTheMachineCanCarry) {
  TemporaryDirectory directory;
  const auto file = directory.path() / "c.yaml";
  const auto with_threads = [&](int threads) {
    write_atomic(
        file, small_campaign("resources: {ranks: 2, threads: " + std::to_string(threads) + "}\n"));
    return problems_of([&] { checked_plan(file.string(), ""); });
  };
  const int cores = available_cores();
  EXPECT_EQ(with_threads(2 * cores), "");
  const std::string text = with_threads(2 * cores + 1);
  EXPECT_NE(text.find(":22:32: resources.threads: 2 ranks of " + std::to_string(2 * cores + 1) +
                      " threads each are too many for scheduler local here"),
            std::string::npos)
      << text;
}

// 94.6 us is the Rayleigh time of the small campaign's smallest grain.
TEST(CheckedPlan, RefusesATimeStepOverTheRayleighTimeAndWarnsOfALongOne) {
  TemporaryDirectory directory;
  const auto file = directory.path() / "c.yaml";
  const auto with_step = [&](const std::string& step) {
    write_atomic(file, small_campaign(kTwoSlips) + "      - {label: b, set: {" +
                           "numerics.time_step: " + step + "}}\n");
    testing::internal::CaptureStderr();
    const std::string problems = problems_of([&] { checked_plan(file.string(), ""); });
    return problems + "|" + testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(with_step("20 us"), "|");
  EXPECT_EQ(
      with_step("40 us"),
      "|warning: " + file.string() +
          ":27:46: case.numerics.time_step: makes the time step 0.423 of the Rayleigh time of "
          "the smallest grain, 9.46e-05 s; over 0.3 of it contacts may gain energy\n");
  EXPECT_EQ(
      with_step("95 us").find(file.string() + ":27:46: case.numerics.time_step: is 9.5e-05 s, "
                                              "over the Rayleigh time"),
      0u)
      << with_step("95 us");
}

TEST(FindRoot, WhatCannotBeLookedAtIsSaidInWords) {
  TemporaryDirectory directory;
  const auto loop = directory.path() / "loop";
  std::filesystem::create_symlink(loop, loop);
  try {
    find_root(loop.string());
    FAIL() << "found a campaign in a loop";
  } catch (const StorageError& error) {
    EXPECT_EQ(std::string(error.what()).find("cannot look into " + loop.string() + ": "), 0u)
        << error.what();
  }
}

class Cli : public Driving {};

TEST_F(Cli, ResumeOfARunWithoutDirectoryNamesTheWayOut) {
  ASSERT_TRUE(make_wish(*store_, run("bed"), Wish::kStop, clock_.now()));
  const RunRow bed = run("bed");
  ASSERT_EQ(bed.state, State::kHeld);
  std::filesystem::remove_all(root_ / bed.directory);
  store_->release_lease(kMe);
  WishOptions options;
  options.where = root_.string();
  options.runs = {"bed-*"};
  const std::string text = problems_of([&] { carry_out(options, Wish::kResume, "goes on", 0.0); });
  EXPECT_NE(text.find(bed.label + ": its directory " + (root_ / bed.directory).string() +
                      " is gone; grouser submit " + yaml().string()),
            std::string::npos)
      << text;
  EXPECT_EQ(run("bed").state, State::kHeld);
}

TEST_F(Cli, ProgressIsOfTheRunsInThePlan) {
  launch(small_campaign("", "campaign: small\n"));
  auto views = view_runs(*store_, root_);
  count_work(*store_, views);
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[1].run.label, "single");
  EXPECT_EQ(views[1].chunks, 1);
  EXPECT_EQ(count_left_out(*store_), 2u);
}

}  // namespace
}  // namespace grouser
