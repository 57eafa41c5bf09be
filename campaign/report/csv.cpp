// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/csv.hpp"

#include <charconv>
#include <cmath>

#include "base/units.hpp"
#include "campaign/report/observables.hpp"

namespace grouser {
namespace {

/// Reads one row from `text` at `at`, leaving `at` behind its line end.
std::vector<std::string> read_row(const std::string& text, std::size_t& at, int& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '\n') ++line;
    if (quoted) {
      if (c != '"') {
        cells.back() += c;
      } else if (at + 1 < text.size() && text[at + 1] == '"') {
        cells.back() += text[++at];
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      cells.emplace_back();
    } else if (c == '\n') {
      ++at;
      break;
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

std::optional<std::size_t> CsvTable::column(const std::string& name) const {
  for (std::size_t i = 0; i < header.size(); ++i)
    if (header[i] == name) return i;
  return std::nullopt;
}

CsvTable parse_csv(const std::string& text) {
  CsvTable table;
  std::size_t at = 0;
  int line = 1;
  while (at < text.size()) {
    const int row_line = line;
    std::vector<std::string> cells = read_row(text, at, line);
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (table.header.empty()) {
      table.header = std::move(cells);
    } else {
      table.rows.push_back(std::move(cells));
      table.lines.push_back(row_line);
    }
  }
  return table;
}

void CsvWriter::cell(const std::string& text) {
  if (row_started_) text_ += ',';
  row_started_ = true;
  if (text.find_first_of(",\"\n\r") == std::string::npos) {
    text_ += text;
    return;
  }
  text_ += '"';
  for (const char c : text) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
  text_ += '"';
}

void CsvWriter::cell(double value) {
  cell(std::isfinite(value) ? format_number(value) : std::string());
}

void CsvWriter::cell(std::size_t value) { cell(std::to_string(value)); }

void CsvWriter::end_row() {
  text_ += '\n';
  row_started_ = false;
}

double number_of(const std::string& cell) {
  double value = 0.0;
  const char* const end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(cell.data(), end, value);
  return error == std::errc() && stop == end ? value : kNaN;
}

}  // namespace grouser
