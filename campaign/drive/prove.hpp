// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/store/store.hpp"
#include "schedulers/scheduler.hpp"

namespace grouser {

/// Where two of database, journal, files and scheduler tell different stories.
struct Difference {
  std::string place;  ///< run directory, or a file of the campaign root
  std::string what;   ///< one sentence
  std::string hint;   ///< what to type, or what happens by itself
};

/// Compares database with journal, run directories and scheduler; changes nothing. Needs the lease:
/// another manager at work would make differences of its own.
/// @return nothing when all four agree. @throws StorageError. Local, but for the scheduler.
std::vector<Difference> prove(const std::filesystem::path& root, const Store& store,
                              Scheduler& scheduler);

}  // namespace grouser
