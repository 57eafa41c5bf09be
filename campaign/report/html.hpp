// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace grouser {

/// Text as it may stand in HTML or SVG content and in double-quoted attributes; control characters
/// other than blanks are replaced and bytes that are not UTF-8 become U+FFFD. Local.
std::string escape_html(std::string_view text);

/// Number for people: `decimals` after the point, a true minus sign, an en dash for NaN. Local.
std::string shown_number(double value, int decimals);

/// Number with so many significant digits, without trailing zeros, for people. Local.
std::string shown_significant(double value, int digits);

/// Whole number with thin spaces between thousands. Local.
std::string shown_count(long long value);

/// Seconds as "3.2 s", "4 min 10 s", "2 h 05 min". Local.
std::string shown_duration(double seconds);

/// Number in SVG coordinates: two decimals at most. Local.
std::string coordinate(double value);

/// An HTML table; cells are already HTML. Numbers are right-aligned by CSS class.
class HtmlTable {
 public:
  /// @param caption for readers and screen readers, plain text, may be ""
  explicit HtmlTable(std::string caption) : caption_(std::move(caption)) {}
  /// @param is_number one per column
  void header(const std::vector<std::string>& cells, const std::vector<bool>& is_number);
  void row(const std::vector<std::string>& cells);
  std::size_t rows() const { return rows_; }
  /// The table in a box that scrolls sideways on its own when it is wider than the page.
  std::string html() const;

 private:
  std::string caption_;
  std::string head_;
  std::string body_;
  std::vector<bool> is_number_;
  std::size_t rows_ = 0;
};

}  // namespace grouser
