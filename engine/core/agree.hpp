// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <string>

#include "base/errors.hpp"
#include "engine/core/communicator.hpp"

namespace grouser {

/// Runs `work`, which may throw on some ranks, and tells every rank the same: "" when all went
/// well, else this rank's own message or that another failed. `work` itself must not be collective
/// unless it throws on all ranks or none. Collective.
template <class Work>
std::string agreed_failure(const Communicator& ranks, const Work& work) {
  std::string failure;
  try {
    work();
  } catch (const std::exception& error) {
    failure = error.what();
  }
  const std::int64_t failed = ranks.max(static_cast<std::int64_t>(failure.empty() ? 0 : 1));
  if (failed == 0) return "";
  return failure.empty() ? "another rank failed" : failure;
}

/// Runs `work` on rank 0 alone. @throws StorageError on every rank when it threw. Collective.
template <class Work>
void on_first_rank(const Communicator& ranks, const Work& work) {
  const std::string failure = agreed_failure(ranks, [&] {
    if (ranks.rank() == 0) work();
  });
  if (!failure.empty()) throw StorageError(failure);
}

}  // namespace grouser
