// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/case.hpp"
#include "campaign/store/store.hpp"

namespace grouser {

/// Keys stay in the order they were put in.
using Json = nlohmann::ordered_json;

/// Indented text that is JSON whatever went into it: bytes that are not UTF-8 are replaced, numbers
/// that are not finite are null. Local.
std::string json_text(const Json& json);

/// Rows of a query as objects by column name. @throws ConfigError when two columns share a name.
Json rows_json(const Table& table);

/// The case as numbers in SI units, keys as in the YAML. Local.
Json case_json(const Case& input);

}  // namespace grouser
