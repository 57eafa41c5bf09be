// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "base/atomic_file.hpp"
#include "base/hash.hpp"
#include "campaign/cli/starter.hpp"
#include "campaign/plan/expand.hpp"
#include "campaign/plan/names.hpp"
#include "small_campaign.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

class Planning : public ::testing::Test {
 protected:
  Plan plan(const std::string& yaml, const std::string& site = "") {
    write_atomic(directory_.path() / "c.yaml", yaml);
    if (site.empty()) return plan_campaign(directory_.path() / "c.yaml", "");
    write_atomic(directory_.path() / "site.yaml", site);
    return plan_campaign(directory_.path() / "c.yaml", directory_.path() / "site.yaml");
  }
  TemporaryDirectory directory_;
};

std::vector<std::string> labels_of(const Plan& plan) {
  std::vector<std::string> labels;
  for (const PlannedRun& run : plan.runs) labels.push_back(run.label);
  return labels;
}

TEST_F(Planning, RunsAreAllCombinationsAndSharedBedsComeFirst) {
  const Plan made = plan(small_campaign(std::string(kTwoSlips) + R"(  - axis: seed
    points:
      - {label: s1, set: {grains.seed: 1}}
      - {label: s2, set: {grains.seed: 2}}
)"));
  ASSERT_EQ(made.runs.size(), 6u);
  EXPECT_TRUE(made.runs[0].is_bed && made.runs[1].is_bed);
  const auto labels = labels_of(made);
  EXPECT_EQ((std::vector<std::string>{labels.begin() + 2, labels.end()}),
            (std::vector<std::string>{"towed-s1", "towed-s2", "slip_20-s1", "slip_20-s2"}));
  EXPECT_EQ(made.runs[2].bed_key, made.runs[0].key);
  EXPECT_EQ(made.runs[3].bed_key, made.runs[1].key);
  EXPECT_EQ(made.runs[4].bed_key, made.runs[0].key);
  EXPECT_EQ(made.runs[2].directory.string(), "runs/towed-s1-" + made.runs[2].key.substr(0, 8));
  EXPECT_EQ(made.runs[0].directory.string(), "beds/bed-" + made.runs[0].key.substr(0, 8));
}

TEST_F(Planning, ExpandingAgainNamesTheSameDirectories) {
  const Plan first = plan(small_campaign(kTwoSlips));
  std::string turned = small_campaign(R"(sweep:
  - axis: slip
    points:
      - {label: slip_40, set: {wheel.slip: 40 %}}
      - {label: slip_20, set: {wheel.slip: 0.2}}
      - {label: towed, set: {wheel.drive: towed}}
)");
  const Plan second = plan(turned);
  std::set<std::string> directories;
  for (const PlannedRun& run : second.runs) directories.insert(run.directory.string());
  for (const PlannedRun& run : first.runs) EXPECT_EQ(directories.count(run.directory.string()), 1u);
}

TEST_F(Planning, WithoutASweepThereIsOneRun) {
  EXPECT_EQ(labels_of(plan(small_campaign("")))[1], "single");
}

TEST_F(Planning, ACaseWithoutAWheelIsOneRunWithoutABed) {
  std::string yaml = small_campaign("");
  const auto wheel = yaml.find("  wheel:");
  yaml.erase(wheel, yaml.find("  output:") - wheel);
  const Plan made = plan(yaml);
  ASSERT_EQ(made.runs.size(), 1u);
  EXPECT_TRUE(made.runs[0].is_bed);
  EXPECT_EQ(made.runs[0].bed_key, "");
}

TEST_F(Planning, ChunksCutWheelRunsEvenlyAndTheLastHasNoEndOfItsOwn) {
  const auto ends = chunk_ends({4, 0.0}, 0.8, 5.0);
  ASSERT_EQ(ends.size(), 4u);
  EXPECT_DOUBLE_EQ(*ends[0], 0.2);
  EXPECT_DOUBLE_EQ(*ends[2], 0.6);
  EXPECT_EQ(ends[3], std::nullopt);
  EXPECT_EQ(chunk_ends({4, 0.0}, 0.0, 5.0).size(), 1u);  // a bed's length is unknown
}

TEST_F(Planning, ChunksOfAGivenLengthAlsoCutBeds) {
  EXPECT_EQ(chunk_ends({0, 0.25}, 0.8, 5.0).size(), 4u);
  EXPECT_EQ(chunk_ends({0, 0.4}, 0.8, 5.0).size(), 2u);
  EXPECT_EQ(chunk_ends({0, 0.5}, 0.0, 2.0).size(), 4u);
  EXPECT_EQ(chunk_ends({0, 0.0}, 0.8, 5.0).size(), 1u);
}

TEST_F(Planning, SurfaceFilesCountFromTheYamlAndAreNamedByTheirContent) {
  const auto plan_with = [&](const std::string& file) {
    return plan(
        small_campaign("sweep:\n  - axis: w\n    points:\n"
                       "      - {label: a, set: {wheel.profile: stl, wheel.stl_file: " +
                       file + "}}\n"));
  };
  write_atomic(directory_.path() / "w.stl", small_surface("one"));
  write_atomic(directory_.path() / "copy.stl", small_surface("one"));
  const Plan made = plan_with("w.stl");
  EXPECT_EQ(made.runs[1].surface, directory_.path() / "w.stl");
  EXPECT_EQ(made.runs[1].input.wheel.stl_file,
            "../../surfaces/" + hash_text(small_surface("one")) + ".stl");
  EXPECT_EQ(made.runs[0].surface, "");
  EXPECT_EQ(plan_with("copy.stl").runs[1].key, made.runs[1].key);
  write_atomic(directory_.path() / "w.stl", small_surface("mended"));
  EXPECT_NE(plan_with("w.stl").runs[1].key, made.runs[1].key);
}

TEST_F(Planning, ASiteReplacesSchedulerAndResources) {
  const Plan made = plan(small_campaign("resources: {ranks: 8, account: mine}\n"),
                         "grouser_site: 1\nscheduler: slurm\n"
                         "resources: {walltime: 2h, partition: batch, account: theirs}\n");
  EXPECT_EQ(made.settings.scheduler, "slurm");
  EXPECT_EQ(made.settings.resources.ranks, 8);
  EXPECT_EQ(made.settings.resources.walltime, 7200.0);
  EXPECT_EQ(made.settings.resources.account, "theirs");
}

TEST_F(Planning, NamesInBracesStandForCampaignAndHome) {
  TemporaryDirectory home;
  write_atomic(home.path() / "small.sh", "module load mpi\n");
  const char* const before = std::getenv("HOME");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("HOME", home.path().c_str(), 1);
  const Plan made = plan(small_campaign(
      "title: \"{campaign}: {} {1, 2}\"\nresources: {setup_file: \"{home}/{campaign}.sh\"}\n"));
  ::setenv("HOME", kept.c_str(), 1);
  EXPECT_EQ(made.title, "small: {} {1, 2}");
  EXPECT_EQ(made.settings.resources.setup_file, home.path() / "small.sh");
}

TEST_F(Planning, SettingsReadBackAsTheyWereWritten) {
  const Plan made = plan(small_campaign(
      "scheduler: pbs\nresources: {ranks: 6, nodes: 2, walltime: 90 min, memory: 64G, "
      "launcher: mpiexec}\nretries: {infrastructure: 7}\n"));
  const Settings back = read_settings(write_settings(made.settings));
  EXPECT_EQ(write_settings(back), write_settings(made.settings));
  EXPECT_EQ(back.resources.walltime, 5400.0);
  EXPECT_EQ(back.retries.infrastructure, 7);
}

TEST_F(Planning, TheStarterIsAGoodCampaign) { EXPECT_EQ(plan(kStarterCampaign).runs.size(), 5u); }

TEST(Names, LabelsArePlainFileNames) {
  for (const char* good : {"a", "slip_20", "s1", "v1.5", "a+b-c", "0"}) EXPECT_TRUE(is_label(good));
  for (const char* bad :
       {"", ".", "..", "-a", ".hidden", "a b", "a/b", "../up", "a;b", "$(x)", "ä", "a\nb"})
    EXPECT_FALSE(is_label(bad)) << bad;
  EXPECT_FALSE(is_label(std::string(65, 'a')));
}

TEST(Names, BatchWordsCannotCarryOptionsOrLines) {
  for (const char* bad : {"-p", "a b", "a\n#SBATCH --x", "a;b", "a$b", "a'b"})
    EXPECT_FALSE(is_batch_name(bad)) << bad;
  for (const char* good : {"", "gpu@v100", "a/b", "proj:1"}) EXPECT_TRUE(is_batch_name(good));
  for (const char* good : {"", "64G", "500MB", "1000"}) EXPECT_TRUE(is_memory(good)) << good;
  for (const char* bad : {"G", "64 G", "64X", "-1G", "64G\n"}) EXPECT_FALSE(is_memory(bad)) << bad;
}

}  // namespace
}  // namespace grouser
