// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// Time as the manager sees it; tests put in their own.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Seconds since 1970.
  virtual double now() = 0;
  /// Returns early when a signal comes.
  virtual void sleep(double seconds) = 0;
};

class SystemClock : public Clock {
 public:
  double now() override;
  void sleep(double seconds) override;
};

}  // namespace grouser
