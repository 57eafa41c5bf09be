// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "campaign/cli/json_text.hpp"

namespace grouser {

/// series.csv as JSON columns, thinned to at most `most` rows, the last one kept; columns are
/// `time_s`, `travel_m` and those of the observables by name. Empty columns when there is no series
/// yet. @throws FormatError. Local.
Json series_answer(const std::filesystem::path& series, std::size_t most);

/// Means of the campaign's runs over their windows, as the report has them: label, state, slip, and
/// pull, gross and sinkage with their standard errors; null where there is none. Reads every
/// run's series: seconds for a large campaign. @throws StorageError, FormatError. Local.
Json points_answer(const std::filesystem::path& root, double now);

}  // namespace grouser
