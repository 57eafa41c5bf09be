// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "base/log.hpp"
#include "engine/core/communicator.hpp"

int main(int argc, char** argv) {
  const grouser::ParallelSession session(&argc, &argv);
  ::testing::InitGoogleTest(&argc, argv);
  const grouser::Communicator ranks;
  grouser::set_up_log(ranks.rank());
  // A failure on any rank must fail the program on all, or mpirun would not see it.
  return ranks.max(static_cast<std::int64_t>(RUN_ALL_TESTS())) == 0 ? 0 : 1;
}
