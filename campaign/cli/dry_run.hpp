// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "campaign/plan/expand.hpp"

namespace grouser {

/// Shows the job script of each run's first chunk, on standard output or as one file per run in
/// `script_dir`, and writes nothing else. The token in them stands for the real one.
void show_scripts(const Plan& plan, const std::filesystem::path& root,
                  const std::filesystem::path& engine, const std::string& script_dir);

}  // namespace grouser
