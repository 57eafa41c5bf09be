// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "campaign/cli/drive_options.hpp"

namespace grouser {

/// Carries the campaign on until nothing more happens by itself or Ctrl-C comes, printing what
/// happens and one progress line per active run. Jobs outlive this function.
/// @return whether the campaign is at rest; false after Ctrl-C
bool drive_in_foreground(OpenCampaign& campaign, const DriveOptions& options);

}  // namespace grouser
