// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/screen.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "campaign/cli/attention.hpp"
#include "campaign/cli/text.hpp"

namespace grouser {
namespace {

constexpr std::size_t kBarWidth = 20;

// What a person should see first.
int rank_of(const RunView& view) {
  if (waits_for_person(view.run.state)) return 0;
  return is_active(view.run.state) ? 1 : is_terminal(view.run.state) ? 3 : 2;
}

std::string percent(double share) {
  const auto whole = std::to_string(static_cast<int>(std::floor(100.0 * share)));
  return std::string(3 - std::min<std::size_t>(whole.size(), 3), ' ') + whole + " %";
}

std::string line_of(const RunView& view, std::size_t label_width) {
  const std::string state = word_of(view.run.state);
  std::string line = view.run.label;
  line.resize(std::max(label_width, line.size()) + 2, ' ');
  line += state;
  line.resize(line.size() + 12 - std::min<std::size_t>(state.size(), 11), ' ');
  line += bar_text(share_of(view), kBarWidth) + percent(share_of(view));
  if (view.progress) {
    line += "  " + view.progress->phase;
    if (view.progress->seconds_left >= 0.0)
      line += "  " + duration_text(view.progress->seconds_left) + " left";
  }
  return view.run.reason.empty() ? line : line + "  " + view.run.reason;
}

// Not in the middle of a character.
std::string cut(const std::string& line, std::size_t columns) {
  if (line.size() <= columns) return line;
  std::size_t end = columns;
  while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0U) == 0x80U) --end;
  return line.substr(0, end);
}

winsize size_of_terminal() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
    size.ws_col = 80;
    size.ws_row = 24;
  }
  return size;
}

}  // namespace

std::string bar_text(double share, std::size_t width) {
  const double of_one = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0;
  const auto full = static_cast<std::size_t>(of_one * static_cast<double>(width));
  return std::string(full, '#') + std::string(width - full, '.');
}

double share_of(const RunView& view) {
  if (view.run.state == State::kCompleted || view.run.state == State::kSteady) return 1.0;
  return view.end_time > 0.0 ? std::clamp(view.time / view.end_time, 0.0, 1.0) : 0.0;
}

std::string screen_text(const std::string& title, const std::vector<RunView>& views,
                        std::size_t columns, std::size_t lines, const std::string& last) {
  std::vector<const RunView*> order;
  double done = 0.0;
  std::size_t label_width = 0;
  for (const RunView& view : views) {
    order.push_back(&view);
    done += share_of(view);
    label_width = std::max(label_width, std::min<std::size_t>(view.run.label.size(), 32));
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const RunView* a, const RunView* b) { return rank_of(*a) < rank_of(*b); });
  const double share = views.empty() ? 0.0 : done / static_cast<double>(views.size());
  std::vector<std::string> text{
      title, bar_text(share, kBarWidth) + percent(share) + "  " + count_states(views)};
  const std::size_t below = last.empty() ? 0 : 1;
  const std::size_t room = lines > text.size() + below ? lines - text.size() - below : 0;
  const std::size_t shown = order.size() <= room ? order.size() : room > 0 ? room - 1 : 0;
  for (std::size_t i = 0; i < shown; ++i) text.push_back(line_of(*order[i], label_width));
  if (shown < order.size() && room > 0)
    text.push_back("... " + std::to_string(order.size() - shown) + " more: grouser status");
  if (below > 0) text.push_back(last);
  text.resize(std::min(text.size(), lines));
  std::string screen;
  for (const std::string& line : text) screen += (screen.empty() ? "" : "\n") + cut(line, columns);
  return screen;
}

FullScreen::FullScreen() { std::cout << "\033[?1049h\033[?25l" << std::flush; }

FullScreen::~FullScreen() { std::cout << "\033[?25h\033[?1049l" << std::flush; }

std::size_t FullScreen::columns() const { return size_of_terminal().ws_col; }

std::size_t FullScreen::lines() const { return size_of_terminal().ws_row; }

void FullScreen::show(const std::string& text) const {
  // Each line is cleared as it is drawn anew, so that nothing flickers.
  std::string drawn = "\033[H";
  for (const char c : text) drawn += c == '\n' ? std::string("\033[K\n") : std::string(1, c);
  std::cout << drawn << "\033[K\033[J" << std::flush;
}

}  // namespace grouser
