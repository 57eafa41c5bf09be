// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "base/atomic_file.hpp"
#include "campaign/plan/expand.hpp"
#include "small_campaign.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

// Messages of a campaign, one per line, with the directory cut off.
std::string problems_of(const std::string& yaml, const std::string& site = "") {
  TemporaryDirectory directory;
  write_atomic(directory.path() / "c.yaml", yaml);
  if (!site.empty()) write_atomic(directory.path() / "site.yaml", site);
  try {
    plan_campaign(directory.path() / "c.yaml", site.empty() ? "" : directory.path() / "site.yaml");
  } catch (const ConfigError& error) {
    std::string text = error.what();
    const std::string prefix = directory.path().string() + "/";
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text;
  }
  return "";
}

std::size_t count_lines(const std::string& text) {
  return text.empty() ? 0
                      : static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
}

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nis missing from\n" << text;
}

TEST(CampaignErrors, FifteenMistakesAreNamedAtOnceWithLineAndColumn) {
  const std::string text = problems_of(R"(grouser: 1
campaign: bad name!
schedular: local
scheduler: slrum
resources:
  ranks: none
  walltime: 8
  partition: "a b"
  memory: lots
chunks: {count: 2, simulated_time: 0.1 s}
case:
  box: {length: 40 cm, width: 12 cm, depth: 10 cm}
  grains:
    density: 2650
    size_curve: [{diameter: 0.4 mm, finer: 0 %}, {diameter: 0.8 mm, finer: 100 %}]
  contact:
    grain_grain: {restitution: 0.5, friction: 0.5}
    grain_box: {restitution: 0.5, friktion: 0.5}
  bed: {depth: 6 cm}
sweep:
  - axis: slip
    points:
      - {label: -rf, set: {grains.seed: 1}}
      - {label: b, set: {grains.sead: 2}}
      - {label: b, set: {grains.seed: two}}
)");
  expect_parts(text,
               {"c.yaml:2:11: campaign: 'bad name!' cannot be a name of a campaign",
                "c.yaml:3:12: schedular: unknown key; did you mean 'scheduler'?",
                "c.yaml:4:12: scheduler: 'slrum' is not one of its words; did you mean 'slurm'?",
                "c.yaml:6:10: resources.ranks: 'none' is not a whole number",
                "c.yaml:7:13: resources.walltime: '8' has no unit",
                "c.yaml:8:14: resources.partition: has characters a scheduler does not take",
                "c.yaml:9:11: resources.memory: is not an amount of memory",
                "c.yaml:10:36: chunks.simulated_time: is given together with count",
                "c.yaml:14:14: case.grains.density: '2650' has no unit",
                "case.contact.grain_box.friction: is missing",
                "case.contact.grain_box.friktion: unknown key; did you mean 'friction'?",
                "c.yaml:23:17: sweep[0].points[0].label: '-rf' cannot be a label",
                "c.yaml:24:39: case.grains.sead: unknown key; did you mean 'seed'?",
                "'b' is given twice on axis slip",
                "c.yaml:25:39: case.grains.seed: 'two' is not a whole number"});
}

TEST(CampaignErrors, AProblemOfManyRunsIsNamedOnce) {
  std::string yaml = small_campaign(kTwoSlips);
  yaml.replace(yaml.find("2650 kg/m3"), 10, "2650 kg   ");
  EXPECT_EQ(count_lines(problems_of(yaml)), 1u) << problems_of(yaml);
}

TEST(CampaignErrors, RulesBetweenValuesAreCheckedForEveryRun) {
  const std::string text = problems_of(small_campaign(R"(sweep:
  - axis: t
    points:
      - {label: short, set: {wheel.travel: 4 cm}}
      - {label: long, set: {wheel.travel: 4 m}}
)"));
  expect_parts(text, {"case.wheel: runs into the end wall"});
}

// 40 x 12 x 6 cm of soil and grains of 9.6 mm that reach 10.3 mm: 38 x 11 x 5 cubes.
TEST(CampaignErrors, MoreRanksThanCubesOfAContactsReachAreRefusedWithWhatFits) {
  const auto with_ranks = [](const std::string& ranks) {
    return problems_of(small_campaign("", "campaign: small\nscheduler: slurm\nresources: {ranks: " +
                                              ranks + ", walltime: 1h}\n"));
  };
  EXPECT_EQ(with_ranks("2090"), "");
  EXPECT_EQ(with_ranks("41"), "");
  expect_parts(with_ranks("2091"),
               {"c.yaml:4:20: resources.ranks: 2091 ranks leave a rank less of the bed than a cube "
                "of the 10.3 mm that a contact reaches; use at most 2090"});
}

TEST(CampaignErrors, ThreadsAreAWholeNumberFromOneOn) {
  const auto with_threads = [](const std::string& threads) {
    return problems_of(small_campaign("resources: {ranks: 1, threads: " + threads + "}\n"));
  };
  EXPECT_EQ(with_threads("2"), "");
  for (const char* nonsense : {"0", "-2", "1025"})
    expect_parts(with_threads(nonsense),
                 {"c.yaml:22:32: resources.threads:", "is out of range; allowed is 1 to 1024"});
  expect_parts(with_threads("all"),
               {"c.yaml:22:32: resources.threads: 'all' is not a whole number"});
}

TEST(CampaignErrors, TwoPointsWithTheSameCaseAreRefused) {
  const std::string text = problems_of(small_campaign(R"(sweep:
  - axis: slip
    points:
      - {label: a, set: {wheel.slip: 20 %}}
      - {label: b, set: {wheel.slip: 0.2}}
)"));
  EXPECT_EQ(text.find("c.yaml:26:9: sweep: run b is the same case as run a; points must differ"),
            0u)
      << text;
}

TEST(CampaignErrors, JoinedLabelsMustDiffer) {
  const std::string text = problems_of(small_campaign(R"(sweep:
  - axis: x
    points:
      - {label: a-b, set: {grains.seed: 1}}
      - {label: a, set: {grains.seed: 2}}
  - axis: y
    points:
      - {label: c, set: {wheel.slip: 1 %}}
      - {label: b-c, set: {wheel.slip: 2 %}}
)"));
  expect_parts(text, {"two runs are labelled a-b-c"});
}

TEST(CampaignErrors, PathsThatLeadThroughAValueAreRefused) {
  expect_parts(problems_of(small_campaign("sweep:\n  - axis: x\n    points:\n"
                                          "      - {label: a, set: {bed.depth.top: 1 cm}}\n")),
               {"'bed.depth.top' does not lead to a value"});
}

TEST(CampaignErrors, ABatchSchedulerNeedsAWalltime) {
  expect_parts(problems_of(small_campaign("scheduler: slurm\n")),
               {"has no walltime, and scheduler slurm needs one"});
}

TEST(CampaignErrors, ABatchWalltimeNeedsRoomForTheStop) {
  for (const char* scheduler : {"slurm", "pbs"})
    EXPECT_EQ(problems_of(small_campaign("scheduler: " + std::string(scheduler) +
                                         "\nresources: {walltime: 59 s}\n")),
              "c.yaml:23:23: resources.walltime: is under 60 s, which is too short for " +
                  std::string(scheduler) +
                  "; batch systems count in minutes, and the engine stops 30 s or more before "
                  "the end");
  EXPECT_EQ(problems_of(small_campaign("scheduler: slurm\nresources: {walltime: 60 s}\n")), "");
  EXPECT_EQ(problems_of(small_campaign("resources: {walltime: 2 s}\n")), "");
}

// Keys of a later version would all be unknown.
TEST(CampaignErrors, AnotherVersionIsTheOnlyThingSaid) {
  EXPECT_EQ(problems_of("grouser: 2\ncampaign: small\nphysics: {}\n"),
            "c.yaml:1:10: grouser: the file is of version 2, and this grouser knows version 1; "
            "use a newer grouser");
  EXPECT_EQ(problems_of(small_campaign(""), "grouser_site: 3\nqueue: x\n"),
            "site.yaml:1:15: grouser_site: the file is of version 3, and this grouser knows "
            "version 1; use a newer grouser");
  expect_parts(problems_of("grouser: one\n"), {"grouser: 'one' is not a whole number"});
}

TEST(CampaignErrors, WhatPbsCannotSayIsRefused) {
  expect_parts(
      problems_of(small_campaign("scheduler: pbs\nresources: {walltime: 1h, qos: fast}\n")),
      {"has a qos, which PBS does not know"});
  expect_parts(
      problems_of(small_campaign("scheduler: pbs\nresources: {walltime: 1h, memory: 4G}\n")),
      {"has memory per node but no nodes"});
}

TEST(CampaignErrors, AMistakeInASiteFileIsFoundThere) {
  const std::string text =
      problems_of(small_campaign(""), "grouser_site: 1\nresources:\n  walltime: 8 kg\nqueue: x\n");
  expect_parts(text, {"site.yaml:3:13: resources.walltime: unit 'kg' cannot be turned into 's'",
                      "site.yaml:4:8: queue: unknown key"});
}

TEST(CampaignErrors, NamesInBracesAreOfAClosedList) {
  EXPECT_EQ(problems_of(small_campaign(R"(title: "{campain} on sand, {date}"
resources:
  launcher: srun -n {rank} --chdir={ROOT}
  setup_file: "{hom}/env.sh"
sweep:
  - axis: w
    points:
      - {label: a, set: {wheel.profile: stl, wheel.stl_file: "{home}/w.stl"}}
)")),
            "c.yaml:22:8: title: knows no {campain}, {date}; did you mean {campaign}? "
            "known here: {campaign}\n"
            "c.yaml:24:13: resources.launcher: knows no {rank}, {ROOT}; did you mean {ranks}? "
            "known here: {campaign}, {home}, {ranks}, {root}, {run}, {threads}\n"
            "c.yaml:25:15: resources.setup_file: knows no {hom}; did you mean {home}? "
            "known here: {campaign}, {home}\n"
            "c.yaml:29:62: case.wheel.stl_file: takes no {name}; "
            "write the path itself; it counts from the YAML file");
}

TEST(CampaignErrors, MissingFilesAreNamed) {
  expect_parts(problems_of(small_campaign(
                   "resources: {setup_file: env.sh}\nsweep:\n  - axis: w\n    points:\n"
                   "      - {label: a, set: {wheel.profile: stl, wheel.stl_file: w.stl}}\n")),
               {"resources.setup_file: '", "env.sh' is not a file", "case.wheel.stl_file: '",
                "w.stl' is not a file"});
}

TEST(CampaignErrors, ASurfaceFileMustHoldASurface) {
  TemporaryDirectory elsewhere;
  write_atomic(elsewhere.path() / "empty.stl", "");
  const auto with = [](const std::filesystem::path& file) {
    return problems_of(
        small_campaign("sweep:\n  - axis: w\n    points:\n"
                       "      - {label: a, set: {wheel.profile: stl, wheel.stl_file: " +
                       file.string() + "}}\n"));
  };
  const std::string empty = with(elsewhere.path() / "empty.stl");
  expect_parts(empty, {"c.yaml:25:62: case.wheel.stl_file: '", "empty.stl' is empty"});
  EXPECT_EQ(count_lines(empty), 1u) << empty;
  expect_parts(with(elsewhere.path()), {"' is not a file"});
  const auto of_text = [&](const std::string& text) {
    write_atomic(elsewhere.path() / "w.stl", text);
    return with(elsewhere.path() / "w.stl");
  };
  const std::string good = small_surface("good");
  EXPECT_EQ(of_text(good), "");
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.rfind(from), from.size(), to);
  };
  const std::string place = "c.yaml:25:62: case.wheel.stl_file: '";
  // The last facet is flat; it is gone; its corner is no number; no surface at all; cut off.
  expect_parts(of_text(replaced("vertex -0.0625 -0.03 0", "vertex 0 0.03 0.01")),
               {place, "w.stl' facet 3 has no area; remove or mend it"});
  expect_parts(of_text(good.substr(0, good.rfind("facet normal"))),
               {place, "is not closed at 3 edges, the first from"});
  expect_parts(of_text(replaced("-0.0625", "nan")),
               {place, "has a facet whose three vertices cannot be read"});
  expect_parts(of_text("notes of the meeting"), {place, "has no facets; give a surface"});
  expect_parts(
      of_text(std::string(80, ' ') + std::string("\7\0\0\0", 4)),
      {place, "is cut off or damaged: it has 84 bytes instead of the 434 of the 7 facets"});
}

TEST(CampaignErrors, ASurfaceMustBeAsLargeAsTheWheel) {
  TemporaryDirectory elsewhere;
  write_atomic(elsewhere.path() / "w.stl", small_surface("metres"));
  const auto with = [&](const std::string& scale) {
    return problems_of(small_campaign(
        "sweep:\n  - axis: w\n    points:\n      - {label: a, set: {wheel.profile: stl, "
        "wheel.stl_scale: " +
        scale + ", wheel.stl_file: " + (elsewhere.path() / "w.stl").string() + "}}\n"));
  };
  EXPECT_EQ(with("1 m"), "");
  EXPECT_EQ(with("0.995 m"), "");
  expect_parts(with("1 mm"), {"c.yaml:25:85: case.wheel.stl_file: '",
                              "w.stl' is 0.000125 m across its axle, wheel.diameter is 0.125 m; "
                              "look at stl_scale"});
}

TEST(CampaignErrors, AReportThatIsNoMapIsRefused) {
  expect_parts(problems_of(small_campaign("report: yes please\n")), {"report: must be a map"});
}

TEST(CampaignErrors, TooManyCombinationsAreRefusedBeforeTheyAreMade) {
  std::string sweep = "sweep:\n";
  for (int axis = 0; axis < 6; ++axis) {
    sweep += "  - axis: a" + std::to_string(axis) + "\n    points:\n";
    for (int point = 0; point < 10; ++point)
      sweep += "      - {label: p" + std::to_string(point) + ", set: {grains.seed: 1}}\n";
  }
  expect_parts(problems_of(small_campaign(sweep)), {"has more than 100000 combinations"});
}

}  // namespace
}  // namespace grouser
