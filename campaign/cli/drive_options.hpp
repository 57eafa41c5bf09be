// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <memory>

#include "campaign/drive/driver.hpp"

namespace grouser {

/// Options of every verb that carries a campaign on.
struct DriveOptions {
  bool take_over = false;
  double grace = -1.0;  ///< < 0: the scheduler kind's own [s]
  double every = -1.0;  ///< between ticks; < 0: the scheduler kind's own [s]
};

void add_drive_options(CLI::App& verb, DriveOptions& options);

/// What is open while a campaign is carried on.
class OpenCampaign {
 public:
  explicit OpenCampaign(std::filesystem::path root);

  /// One tick under the lease. @param patience  how long to wait for another manager [s]
  /// @throws CampaignBusy
  TickReport tick(const DriveOptions& options, double patience);

  /// Seconds between ticks.
  double interval(const DriveOptions& options) const;

  const std::filesystem::path& root() const { return root_; }
  Store& store() { return store_; }
  Clock& clock() { return clock_; }
  Scheduler& scheduler() { return *scheduler_; }

 private:
  std::filesystem::path root_;
  Store store_;
  SystemClock clock_;
  std::string scheduler_name_;
  std::unique_ptr<Scheduler> scheduler_;
};

}  // namespace grouser
