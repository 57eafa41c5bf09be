// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Exit codes of `grouser`; part of its interface (docs/reference/cli.md).
namespace grouser::exit_codes {

inline constexpr int kOk = 0;
inline constexpr int kAttention = 1;  ///< done, but something waits for a person
inline constexpr int kUsage = 2;      ///< the command line is wrong
inline constexpr int kInput = 20;     ///< YAML, SQL or names that cannot be used
inline constexpr int kStorage = 40;   ///< file system or database refused
inline constexpr int kDefect = 70;    ///< internal defect
inline constexpr int kBusy = 75;      ///< another manager is at work; try again later

}  // namespace grouser::exit_codes
