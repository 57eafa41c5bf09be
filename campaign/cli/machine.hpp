// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "campaign/plan/campaign_file.hpp"

namespace grouser {

/// Whether this machine can run the campaign's jobs, for scheduler `local`: at most four ranks or
/// threads per core. Problems are appended. Local.
void check_machine(const CampaignFile& file, std::vector<Problem>& problems);

}  // namespace grouser
