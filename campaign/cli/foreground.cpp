// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/foreground.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <iostream>

#include "campaign/cli/interrupt.hpp"
#include "campaign/cli/progress.hpp"
#include "campaign/drive/lease_guard.hpp"

namespace grouser {
namespace {

// A terminal is drawn anew at every look; a log file gets a line per run only so often.
constexpr double kLogInterval = 10.0;

// The progress lines; on a terminal the new ones replace the old.
class ProgressBlock {
 public:
  void print_message(const std::string& message) {
    erase();
    std::cout << message << std::endl;
  }

  void print(const std::vector<RunView>& views, double now) {
    if (printed_at_ == 0.0) printed_at_ = now;
    if (!is_terminal_ && now - printed_at_ < kLogInterval) return;
    printed_at_ = now;
    erase();
    std::size_t width = 0;
    for (const RunView& view : views)
      if (is_active(view.run.state)) width = std::max(width, view.run.label.size());
    for (const RunView& view : views) {
      if (!is_active(view.run.state)) continue;
      print_line("  " + progress_line(view, width));
    }
    if (is_terminal_) print_line("  " + count_states(views));
    std::cout << std::flush;
  }

 private:
  // A line that the terminal broke in two could not be erased as one.
  void print_line(const std::string& line) {
    winsize size{};
    const bool has_width =
        is_terminal_ && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    std::cout << (has_width ? line.substr(0, size.ws_col) : line) << "\n";
    ++lines_;
  }

  void erase() {
    if (is_terminal_ && lines_ > 0) std::cout << "\033[" << lines_ << "A\033[J";
    lines_ = 0;
  }

  bool is_terminal_ = ::isatty(STDOUT_FILENO) == 1;
  double printed_at_ = 0.0;
  int lines_ = 0;
};

}  // namespace

bool drive_in_foreground(OpenCampaign& campaign, const DriveOptions& options) {
  const InterruptGuard guard;
  ProgressBlock block;
  bool is_waiting = false;
  while (!InterruptGuard::is_interrupted()) {
    try {
      for (const std::string& message : campaign.tick(options, 0.0).messages)
        block.print_message(message);
      is_waiting = false;
    } catch (const CampaignBusy& busy) {
      // Another manager carries the campaign on meanwhile; this one watches.
      if (!is_waiting) block.print_message(busy.what());
      is_waiting = true;
    }
    const auto views = view_runs(campaign.store(), campaign.root());
    if (is_at_rest(campaign.store().runs())) {
      block.print_message(count_states(views));
      return true;
    }
    block.print(views, campaign.clock().now());
    campaign.clock().sleep(campaign.interval(options));
  }
  return false;
}

}  // namespace grouser
