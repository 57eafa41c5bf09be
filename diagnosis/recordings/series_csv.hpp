// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "diagnosis/recordings/recording.hpp"

namespace grouser::diagnosis {

/// Reads the series of `condition` from a CSV file with the recording's columns and units. A row in
/// which the cell of a channel is empty is left out. Appended to `problems`, each with line and
/// column: cells that are no numbers, times that do not rise, columns that are missing, headers
/// whose unit in brackets is not the one declared, fewer than 8 rows. Local.
void read_series(const std::filesystem::path& file, const SeriesRecording& recording,
                 Condition& condition, std::vector<Problem>& problems);

}  // namespace grouser::diagnosis
