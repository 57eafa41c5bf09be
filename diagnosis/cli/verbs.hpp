// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace grouser {

// As campaign/cli/verbs.hpp: one function per verb, each in a file of its name.
void add_blind(CLI::App& app, int& code);
void add_diagnose(CLI::App& app, int& code);
void add_recording(CLI::App& app, int& code);

}  // namespace grouser
