// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "campaign/store/store.hpp"

namespace grouser {

// The changes of the database as lines of the journal, and back.

nlohmann::json json_of(const PlanChange& change);
nlohmann::json json_of(const Change& change);
/// A new attempt with its run and chunk.
nlohmann::json json_of(const AttemptRow& attempt, const RunRow& run, const ChunkRow& chunk);

/// Every row of the database, for a journal that begins when there are rows already.
nlohmann::json json_of_all(const Store& store);

}  // namespace grouser
