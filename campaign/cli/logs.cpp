// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "base/atomic_file.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/verbs.hpp"
#include "schedulers/scripts.hpp"

namespace grouser {
namespace {

struct Options {
  std::string where;
  std::string run;
  std::int64_t attempt = 0;
  std::size_t tail = 40;
  bool only_path = false;
};

// The last `count` lines.
std::string last_lines(const std::string& text, std::size_t count) {
  std::size_t at = text.size();
  if (at > 0 && text[at - 1] == '\n') --at;
  for (; count > 0 && at != std::string::npos; --count)
    at = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  return at == std::string::npos ? text : text.substr(at + 1);
}

int logs(const Options& options) {
  const auto root = find_root(options.where);
  const Store store = Store::open_read_only(root / Store::kFileName);
  for (const RunRow& run : select_runs(store, {options.run}, false)) {
    const auto attempts = store.attempts(run.id);
    const AttemptRow* chosen = nullptr;
    for (const AttemptRow& attempt : attempts)
      if (options.attempt == 0 || attempt.number == options.attempt) chosen = &attempt;
    if (chosen == nullptr)
      throw ConfigError({Problem{run.label, 0, 0, "", "has no such attempt", "see grouser show"}});
    const auto file = root / run.directory / attempt_files::log(chosen->token);
    std::cout << (options.only_path ? "" : "== ") << file.string() << "\n";
    if (options.only_path) continue;
    const auto text = read_file(file);
    std::cout << (text ? last_lines(*text, options.tail) : "(nothing was written yet)\n");
  }
  return exit_codes::kOk;
}

}  // namespace

void add_logs(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("logs", "what an attempt of a run printed");
  verb->add_option("run", options->run, "label, or a pattern with * and ?")->required();
  verb->add_option("--attempt", options->attempt, "number of the attempt; default is the last");
  verb->add_option("--tail", options->tail, "lines from the end")->capture_default_str();
  verb->add_flag("--path", options->only_path, "print the file's name only");
  verb->add_option("-C,--campaign", options->where, "root, name or YAML of the campaign");
  verb->callback([options, &code] { code = logs(*options); });
}

}  // namespace grouser
