// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "diagnosis/blind/cases.hpp"
#include "diagnosis/blind/score.hpp"
#include "diagnosis/cli/verbs.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;
using namespace diagnosis;

struct Options {
  std::string folder;
  std::string generator;
  std::string json;
  std::string half;
  unsigned seed = 1;
  int jobs = 2;
  int most = -1;
  bool is_answered_only = false;
  CaseCounts counts{150, 300, 60, 90};
};

/// Beside this program unless another is named.
std::string generator_of(const Options& options) {
  if (!options.generator.empty()) return options.generator;
  return (fs::read_symlink("/proc/self/exe").parent_path() / "blind-spheres").string();
}

int make(const Options& options) {
  make_cases(options.folder, generator_of(options), options.seed, options.counts);
  std::cout << case_names(options.folder).size() << " cases; their truth is sealed\n";
  return exit_codes::kOk;
}

int run(const Options& options) {
  const RunTally tally = run_cases(options.folder, options.jobs, options.most);
  std::cout << tally.done << " cases diagnosed, " << tally.before << " before, " << tally.failed
            << " failed; the answers are sealed\n";
  return tally.failed > 0 ? exit_codes::kAttention : exit_codes::kOk;
}

int score(const Options& options) {
  const Score score = score_cases(options.folder, options.half, options.is_answered_only);
  std::cout << to_text(score);
  if (!options.json.empty()) write_atomic(options.json, to_json(score));
  return exit_codes::kOk;
}

}  // namespace

void add_blind(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("blind", "test `diagnose` on concealed cases");
  verb->require_subcommand(1);
  CLI::App* make_verb = verb->add_subcommand("make", "make cases and seal their truth");
  CLI::App* run_verb = verb->add_subcommand("run", "diagnose all that have no answer yet");
  CLI::App* score_verb = verb->add_subcommand("score", "open the truth and score the answers");
  for (CLI::App* one : {make_verb, run_verb, score_verb})
    one->add_option("folder", options->folder, "of the cases")->required();
  make_verb->add_option("--seed", options->seed, "of the cases");
  make_verb->add_option("--generator", options->generator,
                        "program; blind-spheres beside this one");
  make_verb->add_option("--nulls", options->counts.nulls, "cases with nothing missing");
  make_verb->add_option("--singles", options->counts.singles, "with one cause of the catalogue");
  make_verb->add_option("--doubles", options->counts.doubles, "with two");
  make_verb->add_option("--unlisted", options->counts.unlisted, "with one of no catalogue");
  run_verb->add_option("--jobs", options->jobs, "cases at a time")->check(CLI::Range(1, 64));
  run_verb->add_option("--most", options->most, "ends after so many cases");
  score_verb->add_flag("--answered", options->is_answered_only,
                       "leave out cases without an answer");
  score_verb->add_option("--json", options->json, "file for the score");
  score_verb->add_option("--half", options->half, "`development` or `test` alone")
      ->check(CLI::IsMember(std::set<std::string>{"development", "test"}));
  make_verb->callback([options, &code] { code = make(*options); });
  run_verb->callback([options, &code] { code = run(*options); });
  score_verb->callback([options, &code] { code = score(*options); });
}

}  // namespace grouser
