// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace grouser {

/// A time series of a run, such as series.csv. Rows are kept until flush, which the caller does
/// with every checkpoint, so that the file never lags behind the state a run continues from.
class SeriesFile {
 public:
  /// Opens the series to go on after `step`: later rows, and a torn last row, are cut off.
  /// @param header columns, the step first, without a line end
  /// @throws StorageError. Local (rank 0).
  SeriesFile(const std::filesystem::path& file, const std::string& header, std::int64_t step);

  /// Adds a row: step, time, the phase if the header has one, then the other columns. NaN becomes
  /// empty.
  void add(std::int64_t step, double time, const std::string& phase,
           const std::vector<double>& values);

  /// Appends the rows added since and syncs. @throws StorageError
  void flush();

 private:
  std::filesystem::path file_;
  std::string rows_;
};

}  // namespace grouser
