// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a campaign when its YAML or its directories change.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "base/hash.hpp"
#include "driving.hpp"

namespace grouser {
namespace {

using Launching = Driving;

constexpr const char* kHead =
    "campaign: small\nscheduler: slurm\n"
    "resources: {walltime: 1h}\n";

std::string with(std::string text, const std::string& old, const std::string& replacement) {
  const auto at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), replacement);
}

std::string original() { return small_campaign(kTwoSlips, kHead); }
std::string with_slip_25() { return with(original(), "slip: 20 %", "slip: 25 %"); }
std::string without_slip_20() {
  return with(original(), "      - {label: slip_20, set: {wheel.slip: 20 %}}\n", "");
}

class Changing : public Driving {
 protected:
  LaunchReport compare(const std::string& text) {
    write_atomic(yaml(), text);
    return compare_plan(plan_campaign(yaml(), ""), yaml(), root_, *store_);
  }
  // The run in the plan, or out of it, whose label starts so.
  RunRow run_of(const std::string& start, bool in_plan) const {
    for (const RunRow& one : store_->runs())
      if (one.in_plan == in_plan && one.label.rfind(start, 0) == 0) return one;
    throw std::runtime_error("no run " + start);
  }
  std::string case_of(const std::string& label) const {
    return read_file(root_ / run(label).directory / run_files::kCase).value_or("");
  }
  double series_interval_of(const RunRow& of) const {
    const auto file = root_ / of.directory / run_files::kCase;
    std::vector<Problem> problems;
    return read_case(load_yaml(file), problems).output.series_interval;
  }
  // Bed settled, both wheel runs at work.
  void start_wheels() {
    settle_bed();
    tick();
  }
};

TEST_F(Launching, AgainChangesNothing) {
  tick();
  const auto before = store_->runs();
  launch_again(*store_);
  EXPECT_EQ(store_->runs().size(), before.size());
  EXPECT_EQ(run("bed").state, State::kQueued);
}

TEST_F(Changing, AChangedCaseIsANewRunUnderTheOldLabel) {
  const std::string old_key = run("slip_20").key;
  const auto report = compare(with_slip_25());
  EXPECT_TRUE(report.is_change());
  EXPECT_EQ(report.added, std::vector<std::string>{"slip_20"});
  EXPECT_EQ(report.gone, std::vector<std::string>{"slip_20"});
  EXPECT_EQ(report.changed_keys, std::vector<std::string>{"sweep"});
  EXPECT_FALSE(report.settings_changed);
  launch(with_slip_25());
  EXPECT_EQ(store_->runs().size(), 4u);
  EXPECT_EQ(run_of("slip_20", true).label, "slip_20");
  EXPECT_NE(run_of("slip_20", true).key, old_key);
  const RunRow left = run_of("slip_20", false);
  EXPECT_EQ(left.label, "slip_20-" + old_key.substr(0, 8));
  EXPECT_EQ(left.state, State::kCancelled);
  EXPECT_TRUE(std::filesystem::exists(root_ / left.directory / run_files::kCase));
}

TEST_F(Changing, ARunThatComesBackGoesOnUnderItsLabel) {
  const std::string old_key = run("slip_20").key;
  launch(with_slip_25());
  EXPECT_EQ(compare(original()).back, std::vector<std::string>{"slip_20"});
  launch(original());
  EXPECT_EQ(store_->runs().size(), 4u);
  EXPECT_EQ(run_of("slip_20", true).key, old_key);
  EXPECT_EQ(run_of("slip_20", true).label, "slip_20");
  EXPECT_EQ(run_of("slip_20", true).state, State::kPlanned);
  EXPECT_EQ(run_of("slip_20", false).state, State::kCancelled);
}

TEST_F(Changing, ARunThatLeavesTheYamlLosesItsJobAndGetsNoOther) {
  start_wheels();
  launch(without_slip_20());
  EXPECT_EQ(run("slip_20").request, "cancel");
  end_engine("towed", EngineCode::kFinished, 305, 0.305);
  tick();
  EXPECT_EQ(scheduler_.cancelled.size(), 1u);
  EXPECT_FALSE(is_at_rest(store_->runs())) << "a job is still there";
  end_engine("slip_20", EngineCode::kPaused, 20, 0.02, true);
  tick();
  EXPECT_EQ(run("slip_20").state, State::kCancelled);
  EXPECT_TRUE(is_at_rest(store_->runs()));
  const auto requests = scheduler_.requests.size();
  for (int i = 0; i < 3; ++i) tick(1000.0);
  EXPECT_EQ(scheduler_.requests.size(), requests);
}

// A manager that died between leaving the run out and cancelling it.
TEST_F(Changing, ARunOutOfThePlanIsNeverSubmitted) {
  for (RunRow one : store_->runs()) {
    one.in_plan = one.kind == RunKind::kBed;
    one.state = one.in_plan ? State::kCompleted : State::kReady;
    Change change;
    change.run = one;
    store_->apply(change);
  }
  tick();
  EXPECT_TRUE(scheduler_.requests.empty());
  EXPECT_TRUE(is_at_rest(store_->runs()));
}

TEST_F(Changing, ComingBackWithdrawsTheCancelOfLeaving) {
  start_wheels();
  launch(without_slip_20());
  launch(original());
  EXPECT_TRUE(run("slip_20").in_plan);
  EXPECT_EQ(run("slip_20").request, "");
}

TEST_F(Changing, RenamedAxesReachTheRunsThatAreThere) {
  launch(with(original(), "axis: slip", "axis: drive"));
  ASSERT_EQ(run("towed").axes.size(), 1u);
  EXPECT_EQ(run("towed").axes.front().axis, "drive");
  EXPECT_EQ(store_->runs().size(), 3u);
}

TEST_F(Changing, CommentsAndLayoutAreNoChange) {
  EXPECT_FALSE(compare("# a comment\n" + original()).is_change());
  EXPECT_FALSE(compare(with(original(), "{walltime: 1h}", "\n  walltime:   1h")).is_change());
}

TEST_F(Changing, WhatTheKeyLeavesOutReachesEveryFrozenCase) {
  tick();
  const std::string text = with(original(), "checkpoint_interval: 20 ms", "series_interval: 7 ms");
  const auto report = compare(text);
  EXPECT_TRUE(report.is_change());
  EXPECT_EQ(report.changed_keys, std::vector<std::string>{"case"});
  EXPECT_EQ(report.recased.size(), 3u);
  EXPECT_EQ(report.recased_active, std::vector<std::string>{run("bed").label});
  launch(text);
  EXPECT_EQ(store_->runs().size(), 3u);
  EXPECT_EQ(run("bed").state, State::kQueued);
  for (const char* label : {"bed", "towed", "slip_20"})
    EXPECT_DOUBLE_EQ(series_interval_of(run(label)), 7e-3) << label;
  EXPECT_FALSE(compare(text).is_change());
}

TEST_F(Changing, TitleAndSettingsAreReplaced) {
  const std::string text = with(with(original(), "campaign: small\n",
                                     "campaign: small\ntitle: Another\nretries: "
                                     "{infrastructure: 9}\n"),
                                "walltime: 1h", "walltime: 2h");
  const auto report = compare(text);
  EXPECT_EQ(report.changed_keys, (std::vector<std::string>{"title", "retries", "resources"}));
  EXPECT_TRUE(report.settings_changed);
  launch(text);
  EXPECT_EQ(store_->campaign().title, "Another");
  EXPECT_EQ(read_settings(store_->campaign().settings).retries.infrastructure, 9);
  EXPECT_EQ(read_file(root_ / kFrozenCampaign), text);
}

TEST_F(Changing, ChangedChunksAreForRunsThatHaveNotBegun) {
  tick();
  const std::string text =
      small_campaign(kTwoSlips, std::string(kHead) + "chunks: {simulated_time: 100 ms}\n");
  const auto report = compare(text);
  EXPECT_EQ(report.changed_keys, std::vector<std::string>{"chunks"});
  EXPECT_EQ(report.kept_chunks, std::vector<std::string>{run("bed").label});
  launch(text);
  EXPECT_EQ(store_->chunks(run("bed").id).size(), 1u);
  const auto chunks = store_->chunks(run("towed").id);
  ASSERT_EQ(chunks.size(), 4u);
  EXPECT_DOUBLE_EQ(*chunks[1].until_time, 0.2);
  EXPECT_EQ(chunks[3].until_time, std::nullopt);
}

TEST_F(Changing, ARunWhoseDirectoryIsGoneStartsAnew) {
  start_wheels();
  end_engine("towed", EngineCode::kFinished, 305, 0.305);
  tick();
  ASSERT_EQ(run("towed").state, State::kCompleted);
  for (const char* label : {"bed", "towed", "slip_20"})
    std::filesystem::remove_all(root_ / run(label).directory);
  const auto report = compare(original());
  EXPECT_EQ(report.anew, (std::vector<std::string>{run("bed").label, "towed"}));
  EXPECT_EQ(report.lost, std::vector<std::string>{"slip_20"});
  EXPECT_FALSE(report.is_change()) << "a person need not say --update";
  launch_again(*store_);
  EXPECT_EQ(run("bed").state, State::kReady);
  EXPECT_EQ(run("bed").step, 0);
  EXPECT_EQ(run("bed").checkpoint, "");
  EXPECT_EQ(run("towed").state, State::kPlanned);
  EXPECT_NE(case_of("towed"), "");
  EXPECT_EQ(store_->attempts(run("towed").id).size(), 1u) << "history stays";
  for (const ChunkRow& chunk : store_->chunks(run("towed").id))
    EXPECT_EQ(chunk.state, State::kPlanned);
  EXPECT_EQ(run("slip_20").state, State::kRunning) << "its job is still there";
  EXPECT_EQ(case_of("slip_20"), "");
  tick();
  EXPECT_EQ(run("bed").state, State::kQueued);
  EXPECT_EQ(run("towed").state, State::kPlanned) << "waits for the new bed";
}

TEST_F(Changing, ASurfaceFileIsCopiedAndKnownByItsContent) {
  const auto stl = [](const std::string& file) {
    return small_campaign(
        "sweep:\n  - axis: w\n    points:\n"
        "      - {label: a, set: {wheel.profile: stl, wheel.stl_file: " +
            file + "}}\n",
        kHead);
  };
  const auto copy = root_ / "surfaces" / (hash_text(small_surface("one")) + ".stl");
  write_atomic(directory_.path() / "w.stl", small_surface("one"));
  write_atomic(directory_.path() / "same.stl", small_surface("one"));
  launch(stl("w.stl"));
  EXPECT_EQ(read_file(copy), small_surface("one"));
  EXPECT_EQ(read_file((root_ / run_of("a", true).directory / "../../surfaces" / copy.filename())
                          .lexically_normal()),
            small_surface("one"));
  std::filesystem::remove(copy);
  const auto moved = compare(stl("same.stl"));
  EXPECT_TRUE(moved.added.empty() && moved.gone.empty());
  launch_again(*store_);
  EXPECT_EQ(read_file(copy), small_surface("one")) << "made again";
  write_atomic(directory_.path() / "same.stl", small_surface("two"));
  EXPECT_EQ(compare(stl("same.stl")).added, std::vector<std::string>{"a"});
}

TEST_F(Changing, AFrozenCaseOfAnotherRunIsRefused) {
  write_atomic(root_ / run("towed").directory / run_files::kCase, case_of("slip_20"));
  EXPECT_THROW(launch_again(*store_), FormatError);
}

class KilledLaunch : public Changing, public ::testing::WithParamInterface<const char*> {
 protected:
  void launch_and_die() {
    const pid_t child = ::fork();
    if (child == 0) {
      ::setenv("GROUSER_FAULT", GetParam(), 1);
      try {
        Store own = open_store();
        launch_again(own);
      } catch (const std::exception&) {
        ::_exit(1);
      }
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "did not come to " << GetParam();
  }
};

TEST_P(KilledLaunch, EndsTheSameWhenItIsDoneAgain) {
  start_wheels();
  end_engine("towed", EngineCode::kFinished, 305, 0.305);
  tick();
  const std::string text = with(with_slip_25(), "checkpoint_interval: 20", "series_interval: 7");
  launch(text);
  launch(original());  // what it leaves behind, cancelled, comes back below
  std::filesystem::remove_all(root_ / run("towed").directory);
  write_atomic(yaml(), text);
  launch_and_die();
  EXPECT_TRUE(compare(text).is_change()) << "asks for --update";
  launch_again(*store_);
  EXPECT_EQ(store_->runs().size(), 4u);
  EXPECT_EQ(run_of("slip_20", true).label, "slip_20");
  EXPECT_EQ(run_of("slip_20", true).state, State::kPlanned);
  EXPECT_EQ(run_of("slip_20", false).request, "cancel");
  EXPECT_EQ(run("towed").state, State::kPlanned);
  EXPECT_EQ(run("towed").step, 0);
  for (const char* label : {"bed", "towed", "slip_20"})
    EXPECT_DOUBLE_EQ(series_interval_of(run_of(label, true)), 7e-3) << label;
  EXPECT_EQ(read_file(root_ / kFrozenCampaign), text);
  EXPECT_FALSE(compare(text).is_change());
}

INSTANTIATE_TEST_SUITE_P(Points, KilledLaunch,
                         ::testing::Values("after_directories", "after_runs", "after_cancels"),
                         [](const auto& point) { return std::string(point.param); });

}  // namespace
}  // namespace grouser
