// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/html.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

/// Length of the UTF-8 sequence that starts at `at`, 0 when there is no sound one.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 && first < 0xF5   ? 4
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xC2 && first < 0xE0 ? 2
                                                             : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xC0) != 0x80) return 0;
  return length;
}

std::string with_minus_sign(std::string text) {
  if (text.empty() || text[0] != '-') return text;
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return (is_zero ? "" : "−") + text.substr(1);
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const std::size_t length = utf8_length(text, at);
    if (length == 0) {
      out += "\uFFFD";
      ++at;
      continue;
    }
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else if (c == '\x7f' || (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t')) {
      out += "\uFFFD";
    } else {
      out += text.substr(at, length);
    }
    at += length;
  }
  return out;
}

std::string shown_number(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  return with_minus_sign(fmt::format("{:.{}f}", value, decimals));
}

std::string shown_significant(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  return with_minus_sign(fmt::format("{:.{}g}", value, digits));
}

std::string shown_count(long long value) {
  std::string digits = std::to_string(value);
  for (auto at = static_cast<long long>(digits.size()) - 3; at > (value < 0 ? 1 : 0); at -= 3)
    digits.insert(static_cast<std::size_t>(at), "\u202F");
  return with_minus_sign(digits);
}

std::string shown_duration(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  if (seconds < 60.0) return shown_number(seconds, 1) + " s";
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string coordinate(double value) {
  if (!std::isfinite(value)) return "0";
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

void HtmlTable::header(const std::vector<std::string>& cells, const std::vector<bool>& is_number) {
  is_number_ = is_number;
  for (std::size_t i = 0; i < cells.size(); ++i)
    head_ += std::string("<th scope=\"col\"") + (is_number_[i] ? " class=\"number\">" : ">") +
             cells[i] + "</th>";
}

void HtmlTable::row(const std::vector<std::string>& cells) {
  body_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i)
    body_ +=
        std::string(i < is_number_.size() && is_number_[i] ? "<td class=\"number\">" : "<td>") +
        cells[i] + "</td>";
  body_ += "</tr>\n";
  ++rows_;
}

std::string HtmlTable::html() const {
  // A box that scrolls must be reachable by keyboard and say what it is.
  return "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" +
         (caption_.empty() ? "table" : escape_html(caption_)) + "\"><table>" +
         (caption_.empty() ? "" : "<caption>" + escape_html(caption_) + "</caption>") +
         "<thead><tr>" + head_ + "</tr></thead>\n<tbody>\n" + body_ + "</tbody></table></div>\n";
}

}  // namespace grouser
