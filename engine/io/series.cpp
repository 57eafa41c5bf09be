// SPDX-License-Identifier: BSD-3-Clause
#include "engine/io/series.hpp"

#include <charconv>
#include <cmath>
#include <fstream>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/units.hpp"

namespace grouser {

SeriesFile::SeriesFile(const std::filesystem::path& file, const std::string& header,
                       std::int64_t step)
    : file_(file) {
  std::string kept = header + "\n";
  const std::string old = read_file(file).value_or("");
  for (std::size_t from = old.find('\n') + 1; from > 0 && from < old.size();) {
    const std::size_t to = old.find('\n', from);
    if (to == std::string::npos) break;
    std::int64_t row_step = 0;
    const auto [end, error] = std::from_chars(old.data() + from, old.data() + to, row_step);
    if (error != std::errc() || row_step > step) break;
    kept.append(old, from, to + 1 - from);
    from = to + 1;
  }
  if (kept != old) write_atomic(file, kept);
}

void SeriesFile::add(std::int64_t step, double time, const std::string& phase,
                     const std::vector<double>& values) {
  rows_ += std::to_string(step) + "," + format_number(time);
  if (!phase.empty()) rows_ += "," + phase;
  for (const double value : values) {
    rows_ += ",";
    if (!std::isnan(value)) rows_ += format_number(value);
  }
  rows_ += "\n";
}

void SeriesFile::flush() {
  if (rows_.empty()) return;
  std::ofstream out(file_, std::ios::app | std::ios::binary);
  out << rows_;
  out.close();
  if (!out) throw StorageError("cannot append to " + file_.string());
  sync_path(file_);
  rows_.clear();
}

}  // namespace grouser
