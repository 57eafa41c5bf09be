// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <stdexcept>

#include "campaign/cli/answers.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/text.hpp"
#include "campaign/cli/verbs.hpp"

namespace grouser {
namespace {

struct Options {
  std::string where;
  std::string sql;
  bool as_json = false;
};

Table answer(const Options& options) {
  const Store store = Store::open_read_only(find_root(options.where) / Store::kFileName);
  try {
    return store.query(options.sql);
  } catch (const std::invalid_argument& error) {
    throw ConfigError(
        {Problem{"query", 0, 0, "", error.what(),
                 "the views are v_status v_runs v_axes v_chunks v_attempts v_seams v_ledger "
                 "v_losses"}});
  }
}

int query(const Options& options) {
  const Table table = answer(options);
  if (!options.as_json) {
    std::cout << text_table(table.columns, table.rows);
    return exit_codes::kOk;
  }
  std::cout << json_text(query_answer(table));
  return exit_codes::kOk;
}

}  // namespace

void add_query(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("query", "read the database with one SELECT over its views");
  verb->add_option("sql", options->sql, "for example \"SELECT * FROM v_ledger\"")->required();
  verb->add_option("-C,--campaign", options->where, "root, name or YAML of the campaign");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->callback([options, &code] { code = query(*options); });
}

}  // namespace grouser
