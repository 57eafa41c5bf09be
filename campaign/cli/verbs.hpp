// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace grouser {

// One function per verb, each in a file of its name; it adds the verb's command line to `app`, and
// the verb writes its exit code to `code`.
void add_cancel(CLI::App& app, int& code);
void add_completion(CLI::App& app, int& code);
void add_doctor(CLI::App& app, int& code);
void add_expand(CLI::App& app, int& code);
void add_fsck(CLI::App& app, int& code);
void add_init(CLI::App& app, int& code);
void add_logs(CLI::App& app, int& code);
void add_manual(CLI::App& app, int& code);
void add_plan(CLI::App& app, int& code);
void add_query(CLI::App& app, int& code);
void add_rebuild(CLI::App& app, int& code);
void add_report(CLI::App& app, int& code);
void add_resume(CLI::App& app, int& code);
void add_schema(CLI::App& app, int& code);
void add_show(CLI::App& app, int& code);
void add_status(CLI::App& app, int& code);
void add_stop(CLI::App& app, int& code);
void add_submit(CLI::App& app, int& code);
void add_tick(CLI::App& app, int& code);
void add_validate(CLI::App& app, int& code);

}  // namespace grouser
