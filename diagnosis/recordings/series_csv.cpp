// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/recordings/series_csv.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include "base/atomic_file.hpp"
#include "base/units.hpp"
#include "campaign/report/csv.hpp"

namespace grouser::diagnosis {
namespace {

constexpr std::size_t kFewestRows = 8;
constexpr std::size_t kMostProblems = 20;  // of one file: a wrong separator would fill pages

/// Column of the cell in its line, 1-based, for cells without quotes.
int place_of(const std::vector<std::string>& row, std::size_t cell) {
  std::size_t place = 1;
  for (std::size_t i = 0; i < cell; ++i) place += row[i].size() + 1;
  return static_cast<int>(place);
}

/// The header without its unit in brackets.
std::string bare(const std::string& header) {
  const std::size_t end = header.find(" [");
  return end == std::string::npos ? header : header.substr(0, end);
}

class SeriesReader {
 public:
  SeriesReader(std::string file, const SeriesRecording& recording, std::vector<Problem>& problems)
      : file_(std::move(file)), recording_(recording), problems_(problems) {}

  void read(const std::string& text, Condition& condition) {
    table_ = parse_csv(text);
    const std::optional<std::size_t> time = find(recording_.time_column, recording_.time_unit);
    std::vector<std::optional<std::size_t>> columns;
    for (const SignalChannel& channel : recording_.channels)
      columns.push_back(find(channel.column, channel.unit));
    if (count_ > 0) return;
    condition.samples.assign(columns.size(), {});
    const double to_seconds = parse_quantity("1 " + recording_.time_unit, "s");
    for (row_ = 0; row_ < table_.rows.size() && count_ < kMostProblems; ++row_)
      read_row(*time, to_seconds, columns, condition);
    if (count_ == 0 && condition.times.size() < kFewestRows)
      report(0, 0, "rows", "has " + std::to_string(condition.times.size()) + " rows",
             "a series needs " + std::to_string(kFewestRows));
  }

 private:
  std::optional<std::size_t> find(const std::string& column, const std::string& unit) {
    for (std::size_t i = 0; i < table_.header.size(); ++i) {
      const std::string& header = table_.header[i];
      if (bare(header) != bare(column)) continue;
      if (bare(header) != header && header != bare(column) + " [" + unit + "]")
        report(1, place_of(table_.header, i), column,
               "the header '" + header + "' has another unit than the '" + unit + "' declared",
               "one of the two is wrong");
      return i;
    }
    report(1, 0, column, "column is missing", "it is named in recording.yaml");
    return std::nullopt;
  }

  void read_row(std::size_t time, double to_seconds,
                const std::vector<std::optional<std::size_t>>& columns, Condition& condition) {
    const std::vector<std::string>& row = table_.rows[row_];
    const int line = table_.lines[row_];
    if (row.size() != table_.header.size()) {
      report(line, 0, "row",
             "has " + std::to_string(row.size()) + " cells instead of " +
                 std::to_string(table_.header.size()),
             "");
      return;
    }
    const double at = to_seconds * number(time, recording_.time_column);
    std::vector<double> values;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const SignalChannel& channel = recording_.channels[i];
      const bool is_missing = row[*columns[i]].empty();
      values.push_back(is_missing ? NAN : channel.to_si * number(*columns[i], channel.column));
      is_incomplete_ = is_incomplete_ || is_missing;
    }
    check_time(at, condition, row, time);
    if (!std::isfinite(at) || is_incomplete_) {
      is_incomplete_ = false;
      return;
    }
    condition.times.push_back(at);
    condition.lines.push_back(line);
    for (std::size_t i = 0; i < values.size(); ++i) condition.samples[i].push_back(values[i]);
  }

  void check_time(double at, const Condition& condition, const std::vector<std::string>& row,
                  std::size_t time) {
    if (condition.times.empty() || !std::isfinite(at) || at > condition.times.back()) return;
    report(
        table_.lines[row_], place_of(row, time), recording_.time_column,
        at == condition.times.back()
            ? "the time is that of line " + std::to_string(condition.lines.back())
            : "the time goes back, behind that of line " + std::to_string(condition.lines.back()),
        "times must rise; leave out rows that were written twice");
  }

  double number(std::size_t cell, const std::string& column) {
    const std::string& text = table_.rows[row_][cell];
    const double value = number_of(text);
    if (!std::isfinite(value))
      report(table_.lines[row_], place_of(table_.rows[row_], cell), column,
             text.empty() ? "is empty" : "'" + text + "' is not a number", "");
    return value;
  }

  void report(int line, int column, const std::string& key, const std::string& problem,
              const std::string& hint) {
    problems_.push_back({file_, line, column, key, problem, hint});
    ++count_;
  }

  std::string file_;
  const SeriesRecording& recording_;
  std::vector<Problem>& problems_;
  CsvTable table_;
  std::size_t row_ = 0;
  std::size_t count_ = 0;
  bool is_incomplete_ = false;
};

}  // namespace

void read_series(const std::filesystem::path& file, const SeriesRecording& recording,
                 Condition& condition, std::vector<Problem>& problems) {
  const std::optional<std::string> text = read_file(file);
  if (!text) {
    problems.push_back({file.string(), 0, 0, "data", "no such file", "it is named in conditions:"});
    return;
  }
  SeriesReader(file.string(), recording, problems).read(*text, condition);
}

}  // namespace grouser::diagnosis
