// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "campaign/store/store.hpp"

namespace grouser {

/// Whether a run in this state goes on only when a person says so.
bool waits_for_person(State state);

/// Names the runs of the plan that wait for a person, why, and how to go on; silent without any.
/// @return exit code: kAttention when there are any, else kOk
int report_waiting(const std::vector<RunRow>& runs, const std::filesystem::path& root);

}  // namespace grouser
