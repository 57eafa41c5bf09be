// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace grouser {

/// A CSV file as text cells. Blank lines are skipped.
struct CsvTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::vector<int> lines;  ///< of the rows in the file, 1-based

  /// Number of the column with that header, if there is one.
  std::optional<std::size_t> column(const std::string& name) const;
};

/// Reads CSV text; cells may be quoted with ", doubled inside. Rows keep the number of cells they
/// have: a row that is being written may be short. Local.
CsvTable parse_csv(const std::string& text);

/// Writes CSV text row by row, quoting what needs it. Lines end in \n.
class CsvWriter {
 public:
  void cell(const std::string& text);
  /// Shortest decimal text that reads back to the same double; empty for NaN and infinities.
  void cell(double value);
  void cell(std::size_t value);
  void end_row();
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool row_started_ = false;
};

/// The number in a cell; NaN for an empty cell or one that is no number. Local.
double number_of(const std::string& cell);

}  // namespace grouser
