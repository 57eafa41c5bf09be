// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "campaign/report/report_data.hpp"

namespace grouser {

/// Reads series.csv (docs/reference/formats/run_directory.md). A last row that is being written is
/// left out. Local. @throws FormatError naming `source` when a column is missing.
RunSeries parse_series(const std::string& text, const std::string& source);

/// Reads slice.csv, keeping at most `max_grains` by taking every n-th. Rows that do not make sense
/// are left out. Local. @throws FormatError naming `source` when a column is missing.
BedSlice parse_slice(const std::string& text, const std::string& source, std::size_t max_grains);

/// track.csv of a run. @throws FormatError naming `source` when a column is missing. Local.
TrackSeries parse_track(const std::string& text, const std::string& source);

}  // namespace grouser
