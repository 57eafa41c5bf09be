// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "campaign/store/columns.hpp"
#include "campaign/store/tables.hpp"

namespace grouser {

// Rows as JSON, by the column lists of columns.hpp: what a new column needs is done there.

inline nlohmann::json json_value(const std::string& value) { return value; }
inline nlohmann::json json_value(const std::filesystem::path& value) { return value.string(); }
inline nlohmann::json json_value(std::int64_t value) { return value; }
inline nlohmann::json json_value(int value) { return value; }
inline nlohmann::json json_value(double value) { return value; }
inline nlohmann::json json_value(bool value) { return value; }
inline nlohmann::json json_value(State value) { return word_of(value); }
inline nlohmann::json json_value(RunKind value) { return word_of(value); }
template <class Table>
nlohmann::json json_value(const RowId<Table>& value) {
  return value.value;
}
template <class Value>
nlohmann::json json_value(const std::optional<Value>& value) {
  return value ? json_value(*value) : nlohmann::json();
}

template <class Value>
void from_json_value(const nlohmann::json& json, Value& value) {
  json.get_to(value);
}
inline void from_json_value(const nlohmann::json& json, std::filesystem::path& value) {
  value = json.get<std::string>();
}
inline void from_json_value(const nlohmann::json& json, State& value) {
  value = state_from(json.get<std::string>());
}
inline void from_json_value(const nlohmann::json& json, RunKind& value) {
  value = json.get<std::string>() == "bed" ? RunKind::kBed : RunKind::kWheel;
}
template <class Table>
void from_json_value(const nlohmann::json& json, RowId<Table>& value) {
  json.get_to(value.value);
}
template <class Value>
void from_json_value(const nlohmann::json& json, std::optional<Value>& value) {
  value.reset();
  if (!json.is_null()) from_json_value(json, value.emplace());
}

class JsonColumns {
 public:
  template <class Value>
  void operator()(const char* name, const Value& value) {
    json[name] = json_value(value);
  }
  nlohmann::json json = nlohmann::json::object();
};

/// A column that the text lacks, from before it was added, keeps its default.
class ColumnsFromJson {
 public:
  explicit ColumnsFromJson(const nlohmann::json& json) : json_(json) {}
  template <class Value>
  void operator()(const char* name, Value& value) {
    if (const auto at = json_.find(name); at != json_.end()) from_json_value(*at, value);
  }

 private:
  const nlohmann::json& json_;
};

/// A row with its id; axes of a run included.
template <class Row>
nlohmann::json row_json(const Row& row) {
  JsonColumns columns;
  TableOf<Row>::visit(columns, row);
  columns.json["id"] = row.id.value;
  if constexpr (std::is_same_v<Row, RunRow>) {
    columns.json["axes"] = nlohmann::json::array();
    for (const AxisLabel& axis : row.axes) columns.json["axes"].push_back({axis.axis, axis.label});
  }
  return columns.json;
}

template <class Row>
Row row_from_json(const nlohmann::json& json) {
  Row row;
  ColumnsFromJson columns(json);
  TableOf<Row>::visit(columns, row);
  json.at("id").get_to(row.id.value);
  if constexpr (std::is_same_v<Row, RunRow>)
    for (const auto& axis : json.at("axes"))
      row.axes.push_back({axis.at(0).get<std::string>(), axis.at(1).get<std::string>()});
  return row;
}

inline nlohmann::json campaign_json(const CampaignRow& row) {
  JsonColumns columns;
  columns_of_campaign(columns, row);
  return columns.json;
}

inline CampaignRow campaign_from_json(const nlohmann::json& json) {
  CampaignRow row;
  ColumnsFromJson columns(json);
  columns_of_campaign(columns, row);
  return row;
}

}  // namespace grouser
