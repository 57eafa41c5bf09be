// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/change.hpp"

#include "campaign/store/database.hpp"
#include "campaign/store/row_json.hpp"

namespace grouser {
namespace {

using Json = nlohmann::json;

Json ends_json(const std::vector<std::optional<double>>& ends) {
  Json json = Json::array();
  for (const auto& end : ends) json.push_back(json_value(end));
  return json;
}

std::vector<std::optional<double>> ends_from_json(const Json& json) {
  std::vector<std::optional<double>> ends;
  for (const Json& end : json) from_json_value(end, ends.emplace_back());
  return ends;
}

template <class Row>
void put(Json& json, const char* name, const std::optional<Row>& row) {
  if (row) json[name] = row_json(*row);
}

template <class Row>
std::optional<Row> take(const Json& json, const char* name) {
  const auto at = json.find(name);
  if (at == json.end()) return std::nullopt;
  return row_from_json<Row>(*at);
}

PlanChange plan_from_json(const Json& json) {
  PlanChange change;
  change.campaign = campaign_from_json(json.at("campaign"));
  for (const Json& run : json.at("runs")) change.runs.push_back(row_from_json<RunRow>(run));
  for (const Json& one : json.at("added"))
    change.added.push_back({row_from_json<RunRow>(one.at("run")),
                            one.at("bed_key").get<std::string>(),
                            ends_from_json(one.at("chunk_ends"))});
  for (const Json& one : json.at("recut"))
    change.recut.push_back(
        {RunId{one.at("run").get<std::int64_t>()}, ends_from_json(one.at("chunk_ends"))});
  return change;
}

template <class Row>
void put_with_id(SQLite::Database& database, const Json& rows) {
  for (const Json& json : rows) {
    const Row row = row_from_json<Row>(json);
    const std::int64_t given = insert_row(database, row);
    // Other rows name it by its number.
    SQLite::Statement renumber(
        database, std::string("UPDATE ") + TableOf<Row>::name + " SET id = ? WHERE id = ?");
    renumber.bind(1, row.id.value);
    renumber.bind(2, given);
    renumber.exec();
    if constexpr (std::is_same_v<Row, RunRow>) put_axes(database, row.id.value, row.axes);
  }
}

void put_rows(SQLite::Database& database, const Json& json) {
  WriteTransaction transaction(database);
  put_campaign(database, campaign_from_json(json.at("campaign")));
  if (json.contains("runs")) put_with_id<RunRow>(database, json.at("runs"));
  if (json.contains("chunks")) put_with_id<ChunkRow>(database, json.at("chunks"));
  if (json.contains("attempts")) put_with_id<AttemptRow>(database, json.at("attempts"));
  transaction.commit();
}

}  // namespace

Json json_of(const PlanChange& change) {
  Json runs = Json::array();
  for (const RunRow& run : change.runs) runs.push_back(row_json(run));
  Json added = Json::array();
  for (const NewRun& one : change.added)
    added.push_back({{"run", row_json(one.row)},
                     {"bed_key", one.bed_key},
                     {"chunk_ends", ends_json(one.chunk_ends)}});
  Json recut = Json::array();
  for (const Recut& one : change.recut)
    recut.push_back({{"run", one.run.value}, {"chunk_ends", ends_json(one.ends)}});
  return {{"op", "plan"},
          {"campaign", campaign_json(change.campaign)},
          {"runs", runs},
          {"added", added},
          {"recut", recut}};
}

Json json_of(const Change& change) {
  Json json{{"op", "change"}};
  put(json, "run", change.run);
  put(json, "chunk", change.chunk);
  put(json, "attempt", change.attempt);
  put(json, "chunk_after", change.chunk_after);
  if (change.drop_planned_chunks) json["drop_planned_chunks"] = true;
  return json;
}

Json json_of(const AttemptRow& attempt, const RunRow& run, const ChunkRow& chunk) {
  return {{"op", "attempt"},
          {"attempt", row_json(attempt)},
          {"run", row_json(run)},
          {"chunk", row_json(chunk)}};
}

Json json_of_all(const Store& store) {
  Json json{{"op", "rows"}, {"campaign", campaign_json(store.campaign())}};
  for (const RunRow& run : store.runs()) json["runs"].push_back(row_json(run));
  for (const ChunkRow& chunk : store.chunks()) json["chunks"].push_back(row_json(chunk));
  for (const AttemptRow& attempt : store.attempts()) json["attempts"].push_back(row_json(attempt));
  return json;
}

void Store::redo(const std::string& line) {
  const Json json = Json::parse(line);
  const std::string op = json.at("op").get<std::string>();
  if (op == "plan") {
    replace_plan(plan_from_json(json));
  } else if (op == "attempt") {
    add_attempt(row_from_json<AttemptRow>(json.at("attempt")),
                row_from_json<RunRow>(json.at("run")), row_from_json<ChunkRow>(json.at("chunk")));
  } else if (op == "change") {
    Change change;
    change.run = take<RunRow>(json, "run");
    change.chunk = take<ChunkRow>(json, "chunk");
    change.attempt = take<AttemptRow>(json, "attempt");
    change.chunk_after = take<ChunkRow>(json, "chunk_after");
    change.drop_planned_chunks = json.value("drop_planned_chunks", false);
    apply(change);
  } else if (op == "rows") {
    put_rows(*impl_->database, json);
  } else {
    throw FormatError("the journal has a change of an unknown kind '" + op + "'");
  }
  impl_->database->exec("UPDATE journal SET number = " +
                        std::to_string(json.at("n").get<std::int64_t>()));
}

}  // namespace grouser
