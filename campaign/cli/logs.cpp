// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "campaign/cli/answers.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {
namespace {

struct Options {
  std::string where;
  std::string run;
  std::int64_t attempt = 0;
  std::size_t tail = 40;
  bool only_path = false;
  bool as_json = false;
};

int logs(const Options& options) {
  const auto root = find_root(options.where);
  const Store store = Store::open_read_only(root / Store::kFileName);
  std::vector<LogTail> logs;
  for (const RunRow& run : select_runs(store, {options.run}, false))
    logs.push_back(read_log(store, root, run, options.attempt, options.tail));
  if (options.as_json) {
    std::cout << json_text(logs_answer(logs));
    return exit_codes::kOk;
  }
  for (const LogTail& log : logs) {
    std::cout << (options.only_path ? "" : "== ") << log.file.string() << "\n";
    if (!options.only_path) std::cout << (log.is_there ? log.text : "(nothing was written yet)\n");
  }
  return exit_codes::kOk;
}

}  // namespace

void add_logs(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("logs", "what an attempt of a run printed");
  verb->add_option("run", options->run, "label, or a pattern with * and ?")->required();
  verb->add_option("--attempt", options->attempt, "number of the attempt; default is the last");
  verb->add_option("--tail", options->tail, "lines from the end, of the last MiB")
      ->capture_default_str();
  verb->add_flag("--path", options->only_path, "print the file's name only");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->add_option("-C,--campaign", options->where, "root, name or YAML of the campaign");
  verb->callback([options, &code] { code = logs(*options); });
}

}  // namespace grouser
