// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "campaign/cli/answers.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/text.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {
namespace {

struct Options {
  std::string where;
  std::vector<std::string> runs;
  bool as_json = false;
};

void print_run(const Store& store, const std::filesystem::path& root, const RunRow& run) {
  std::cout << run.label << "  " << word_of(run.kind) << "  " << word_of(run.state);
  if (!run.reason.empty()) std::cout << "  (" << run.reason << ")";
  if (!run.in_plan) std::cout << "  (the YAML no longer has it)";
  std::cout << "\n  directory   " << (root / run.directory).string() << "\n  case        "
            << run.key << "\n";
  if (run.bed) std::cout << "  bed         " << store.run(*run.bed).label << "\n";
  for (const AxisLabel& point : run.axes)
    std::cout << "  " << point.axis << " = " << point.label << "\n";
  if (!run.checkpoint.empty())
    std::cout << "  checkpoint  " << run.checkpoint << " at step " << run.step << ", "
              << short_number(run.time, 6) << " s, hash " << run.state_hash << "\n";
  std::vector<std::vector<std::string>> chunks;
  for (const ChunkRow& chunk : store.chunks(run.id))
    chunks.push_back({std::to_string(chunk.position), word_of(chunk.state),
                      chunk.until_time ? short_number(*chunk.until_time, 6) + " s" : "end",
                      short_number(chunk.time, 6) + " s"});
  std::cout << "\n" << text_table({"CHUNK", "STATE", "UNTIL", "REACHED"}, chunks);
  std::vector<std::vector<std::string>> attempts;
  for (const AttemptRow& attempt : store.attempts(run.id))
    attempts.push_back({std::to_string(attempt.number), attempt.token, attempt.job,
                        word_of(attempt.state), attempt.outcome_class,
                        std::to_string(attempt.start_step), std::to_string(attempt.step),
                        short_number(attempt.wall_seconds) + " s", attempt.reason});
  std::cout << "\n"
            << text_table({"ATTEMPT", "TOKEN", "JOB", "STATE", "CLASS", "FROM STEP", "TO STEP",
                           "WALL", "REASON"},
                          attempts)
            << "\n";
}

int show(const Options& options) {
  const auto root = find_root(options.where);
  const Store store = Store::open_read_only(root / Store::kFileName);
  const auto runs = select_runs(store, options.runs, false);
  if (options.as_json) {
    std::cout << json_text(show_answer(store, runs));
    return exit_codes::kOk;
  }
  for (const RunRow& run : runs) print_run(store, root, run);
  return exit_codes::kOk;
}

}  // namespace

void add_show(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("show", "chunks and attempts of runs");
  verb->add_option("runs", options->runs, "labels, or patterns with * and ?")->required();
  verb->add_option("-C,--campaign", options->where, "root, name or YAML of the campaign");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->callback([options, &code] { code = show(*options); });
}

}  // namespace grouser
