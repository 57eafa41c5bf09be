// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/lease_guard.hpp"

#include "base/log.hpp"
#include "schedulers/process.hpp"

namespace grouser {
namespace {

constexpr double kStep = 0.1;

bool may_replace(const LeaseHolder& holder, bool take_over) {
  const auto alive = is_alive({holder.host, holder.boot, holder.pid, holder.start});
  return take_over || (alive.has_value() && !*alive);
}

}  // namespace

LeaseGuard::LeaseGuard(Store& store, Clock& clock, double patience, bool take_over)
    : store_(store) {
  const ProcessId self = this_process();
  me_ = {self.host, self.boot, self.pid, self.start, 0};
  const double end = clock.now() + patience;
  for (;;) {
    const auto holder = store_.take_lease(
        me_, [&](const LeaseHolder& other) { return may_replace(other, take_over); });
    if (!holder) return;
    if (clock.now() >= end)
      throw CampaignBusy(
          "process " + std::to_string(holder->pid) + " on " + holder->host +
          " is at work on this campaign; try again when it is done" +
          (holder->host == self.host ? "" : ", or use --take-over if you know that it has ended"));
    clock.sleep(kStep);
  }
}

LeaseGuard::~LeaseGuard() {
  try {
    store_.release_lease(me_);
  } catch (const std::exception& error) {
    // The next manager on this host sees that this process is gone.
    spdlog::warn("the lease could not be given back: {}", error.what());
  }
}

}  // namespace grouser
