// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "campaign/cli/progress.hpp"

namespace grouser {

/// "####......" : that share of `width` characters. Local.
std::string bar_text(double share, std::size_t width);

/// How much of the run's simulated time is done, 0 to 1. Local.
double share_of(const RunView& view);

/// One screen of a campaign: counts, the whole, then the runs, those that wait for a person first,
/// then those at work, each with a bar; what does not fit is counted in the last line. No line is
/// longer than `columns`, no more lines than `lines`. Pure.
/// @param last  the line at the bottom, for what is due; "" = none
std::string screen_text(const std::string& title, const std::vector<RunView>& views,
                        std::size_t columns, std::size_t lines, const std::string& last);

/// The terminal's other screen while it lives; what was there before comes back after it.
class FullScreen {
 public:
  FullScreen();
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;
  ~FullScreen();

  std::size_t columns() const;
  std::size_t lines() const;
  void show(const std::string& text) const;
};

}  // namespace grouser
