// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace grouser {

/// The verb `serve`, as the others in campaign/cli/verbs.hpp.
void add_serve(CLI::App& app, int& code);

}  // namespace grouser
