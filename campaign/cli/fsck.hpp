// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "campaign/cli/drive_options.hpp"

namespace grouser {

/// Proves that database, journal, files and scheduler agree and prints what does not.
/// @return exit code: 0 when all agree
int prove_and_print(OpenCampaign& campaign, bool take_over, bool as_json);

}  // namespace grouser
