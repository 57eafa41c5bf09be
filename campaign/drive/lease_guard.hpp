// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

#include "campaign/drive/clock.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// Another manager is at work on the campaign; its words name it.
class CampaignBusy : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Holds the campaign's lease while it lives. A lease of a process that no longer runs on this host
/// is taken over; one of another host only when `take_over` says so, because from here it cannot
/// be seen whether it still works.
class LeaseGuard {
 public:
  /// @param patience  how long to wait for another manager [s]
  /// @throws CampaignBusy
  LeaseGuard(Store& store, Clock& clock, double patience, bool take_over);
  LeaseGuard(const LeaseGuard&) = delete;
  LeaseGuard& operator=(const LeaseGuard&) = delete;
  ~LeaseGuard();

 private:
  Store& store_;
  LeaseHolder me_;
};

}  // namespace grouser
