// SPDX-License-Identifier: BSD-3-Clause
#include "base/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>

#include <string>

namespace grouser {

void set_up_log(int rank) {
  auto logger = spdlog::stderr_logger_mt("grouser");
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e %l rank=" + std::to_string(rank) + " %v");
  logger->set_level(rank == 0 ? spdlog::level::info : spdlog::level::warn);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace grouser
